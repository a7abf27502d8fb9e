/// The program as it is run, and the recipe of docs/serving.md with nginx in place of it.

#include <chrono>
#include <csignal>
#include <fstream>
#include <thread>

#include "tests/apps/run_program.h"
#include "tests/apps/serve/raw_client.h"
#include "tests/hierarchy/built_file.h"
#include "tests/hierarchy/surfaces.h"

namespace cuesta::test {
namespace {

using namespace std::chrono_literals;

std::string first_line_of(const std::filesystem::path& path) {
  for (int i = 0; i < 1000; ++i) {
    const std::string text = read_text(path);
    if (const auto end = text.find('\n'); end != text.npos) return text.substr(0, end);
    std::this_thread::sleep_for(10ms);
  }
  return "";
}

std::uint16_t port_of(const std::string& line) {
  const auto colon = line.find(':', line.find("//"));
  return static_cast<std::uint16_t>(std::atoi(line.c_str() + colon + 1));
}

TEST(ServeCommand, serves_what_appears_until_it_is_stopped) {
  const TestFolder folder;
  std::filesystem::create_directories(folder / "served");
  build_file(bumpy_sphere(6), folder / "first.cuesta");
  Program program(folder, {"serve", (folder / "served").string(), "--port", "0", "--no-thumbnails"});
  const std::uint16_t port = port_of(first_line_of(folder / "stdout"));
  ASSERT_NE(port, 0);
  EXPECT_EQ(RawClient(port).ask("/data/first.cuesta").status, 404);
  std::filesystem::rename(folder / "first.cuesta", folder / "served/first.cuesta");
  int status = 404;
  for (int i = 0; i < 100 && status == 404; ++i, std::this_thread::sleep_for(100ms))
    status = RawClient(port).ask("/data/first.cuesta").status;
  EXPECT_EQ(status, 200);
  ASSERT_EQ(kill(program.id(), SIGTERM), 0);
  const Outcome outcome = program.wait();
  EXPECT_EQ(outcome.status, 0) << outcome.err;
}

TEST(ServeCommand, a_path_that_is_not_there_is_an_error) {
  const TestFolder folder;
  const Outcome outcome = run(folder, {"serve", (folder / "no").string(), "--port", "0"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("no such file or folder"), std::string::npos);
}

/// What docs/serving.md says between the lines "```nginx NAME" and "```".
std::string recipe(const std::string& name) {
  const std::string text = read_text(std::filesystem::path(CUESTA_SOURCE_DIR) / "docs/serving.md");
  const std::string mark = "```nginx " + name + "\n";
  const auto from = text.find(mark);
  return from == text.npos ? ""
                           : text.substr(from + mark.size(), text.find("```", from + 3) - from - mark.size());
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (auto at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
    text.replace(at, from.size(), to);
  return text;
}

bool has_nginx() {
  return std::system("nginx -v >/dev/null 2>&1") == 0;
}

/// A port that nobody listens at now.
std::uint16_t free_port() {
  const serve::Descriptor s(::socket(AF_INET, SOCK_STREAM, 0));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (::bind(s.get(), reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      ::getsockname(s.get(), reinterpret_cast<sockaddr*>(&address), &size) != 0)
    return 0;
  return ntohs(address.sin_port);
}

/// nginx with the `server` block of a recipe, as a program of the test.
class Nginx {
 public:
  Nginx(const TestFolder& folder, const std::string& server) : folder_(folder.path()) {
    std::ofstream(folder / "nginx.conf")
        << "daemon off; master_process off; pid " << (folder / "nginx.pid").string() << "; error_log "
        << (folder / "nginx.log").string() << ";\nevents {}\nhttp {\naccess_log off;\n"
        << "client_body_temp_path " << (folder / "t1").string() << ";\nproxy_temp_path "
        << (folder / "t2").string() << ";\nfastcgi_temp_path " << (folder / "t3").string()
        << ";\nuwsgi_temp_path " << (folder / "t4").string() << ";\nscgi_temp_path "
        << (folder / "t5").string() << ";\n"
        << server << "\n}\n";
    const std::string conf = (folder / "nginx.conf").string();
    id_ = fork();
    if (id_ == 0) {
      execlp("nginx", "nginx", "-c", conf.c_str(), nullptr);
      _exit(127);
    }
  }
  ~Nginx() {
    kill(id_, SIGTERM);
    waitpid(id_, nullptr, 0);
  }
  bool answers(std::uint16_t port) const {
    for (int i = 0; i < 200; ++i, std::this_thread::sleep_for(20ms))
      if (RawClient(port).connected()) return true;
    return false;
  }
  std::string log() const { return read_text(folder_ / "nginx.log"); }

 private:
  std::filesystem::path folder_;
  pid_t id_ = -1;
};

/// What any client of ours relies on.
void expect_ranges_work(std::uint16_t port, const std::string& target, const std::string& bytes) {
  RawClient c(port);
  const Reply part = c.ask(target, "Range: bytes=64-163\r\nOrigin: http://elsewhere\r\n");
  EXPECT_EQ(part.status, 206);
  EXPECT_EQ(part.body, bytes.substr(64, 100));
  EXPECT_EQ(part.header("Access-Control-Allow-Origin"), "*");
  EXPECT_NE(part.header("Access-Control-Expose-Headers").find("Content-Range"), std::string::npos);
  const std::string etag = part.header("ETag");
  EXPECT_TRUE(etag.starts_with('"')) << etag;
  EXPECT_EQ(c.ask(target, "Range: bytes=-10\r\n").body, bytes.substr(bytes.size() - 10));
  EXPECT_EQ(c.ask(target, "If-None-Match: " + etag + "\r\n").status, 304);
  EXPECT_EQ(c.ask(target, "If-Match: \"older\"\r\nRange: bytes=0-9\r\n").status, 412);
  EXPECT_EQ(RawClient(port).ask(target, "Access-Control-Request-Headers: range\r\n", "OPTIONS").status, 204);
}

TEST(ServingRecipes, static_files_of_nginx) {
  if (!has_nginx()) GTEST_SKIP() << "nginx is not installed";
  const TestFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms(0755));
  std::filesystem::create_directories(folder / "site/data");
  build_file(bumpy_sphere(8), folder / "site/data/sphere.cuesta");
  const std::uint16_t port = free_port();
  const Nginx nginx(folder, replaced(replaced(recipe("static"), "listen 80;",
                                              "listen 127.0.0.1:" + std::to_string(port) + ";"),
                                     "/srv/cuesta", (folder / "site").string()));
  ASSERT_TRUE(nginx.answers(port)) << nginx.log();
  expect_ranges_work(port, "/data/sphere.cuesta", read_text(folder / "site/data/sphere.cuesta"));
}

TEST(ServingRecipes, nginx_before_the_server) {
  if (!has_nginx()) GTEST_SKIP() << "nginx is not installed";
  const TestFolder folder;
  std::filesystem::create_directories(folder / "served");
  build_file(bumpy_sphere(8), folder / "served/sphere.cuesta");
  Program program(folder, {"serve", (folder / "served").string(), "--port", "0", "--no-thumbnails"});
  const std::uint16_t ours = port_of(first_line_of(folder / "stdout")), port = free_port();
  const std::string server =
      replaced(replaced(recipe("proxy"), "listen 80;", "listen 127.0.0.1:" + std::to_string(port) + ";"),
               "127.0.0.1:8080", "127.0.0.1:" + std::to_string(ours));
  {
    const Nginx nginx(folder, server);
    ASSERT_TRUE(nginx.answers(port)) << nginx.log();
    expect_ranges_work(port, "/data/sphere.cuesta", read_text(folder / "served/sphere.cuesta"));
  }
  kill(program.id(), SIGINT);
  EXPECT_EQ(program.wait().status, 0);
}

}  // namespace
}  // namespace cuesta::test
