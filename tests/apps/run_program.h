#pragma once
/// Runs the built `cuesta` as a user would: words in, exit status and both streams out.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

extern char** environ;

namespace cuesta::test {

struct Outcome {
  int status = -1;  ///< exit status; -signal if a signal ended it
  std::string out, err;
};

inline std::string read_text(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  return text.str();
}

/// A folder of its own for a test, removed afterwards.
class TestFolder {
 public:
  TestFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "cuesta-test-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) throw std::runtime_error("no temporary folder");
    path_ = name;
  }
  ~TestFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TestFolder(const TestFolder&) = delete;
  TestFolder& operator=(const TestFolder&) = delete;
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// The program in the background.
class Program {
 public:
  Program(const TestFolder& folder, std::vector<std::string> words) : folder_(folder.path()) {
    words.insert(words.begin(), CUESTA_EXECUTABLE);
    std::vector<char*> pointers;
    for (std::string& word : words) pointers.push_back(word.data());
    pointers.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    const int flags = O_WRONLY | O_CREAT | O_TRUNC;
    posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&actions, 1, (folder_ / "stdout").c_str(), flags, 0600);
    posix_spawn_file_actions_addopen(&actions, 2, (folder_ / "stderr").c_str(), flags, 0600);
    if (posix_spawn(&id_, CUESTA_EXECUTABLE, &actions, nullptr, pointers.data(), environ) != 0) id_ = -1;
    posix_spawn_file_actions_destroy(&actions);
  }
  pid_t id() const { return id_; }
  Outcome wait() {
    int status = 0;
    if (id_ < 0 || waitpid(id_, &status, 0) != id_) return {};
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status), read_text(folder_ / "stdout"),
            read_text(folder_ / "stderr")};
  }

 private:
  std::filesystem::path folder_;
  pid_t id_ = -1;
};

inline Outcome run(const TestFolder& folder, std::vector<std::string> words) {
  return Program(folder, std::move(words)).wait();
}

}  // namespace cuesta::test
