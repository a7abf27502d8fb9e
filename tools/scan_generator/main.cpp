/// cuesta-make-scan INPUT OUTPUT.ply --triangles N [--seed S] [--permute]

#include <fmt/format.h>

#include <charconv>
#include <cstdio>
#include <string_view>

#include "ooc/mesh_reader.h"
#include "tools/scan_generator/make_scan.h"

namespace {

constexpr std::uint64_t input_memory_bytes = 4ull << 30;
constexpr const char* usage =
    "usage: cuesta-make-scan INPUT OUTPUT.ply --triangles N [--seed S] [--permute]\n"
    "Makes a scan of at least N triangles from a small manifold one: smooth subdivision, then roughness.\n";

struct Arguments {
  std::vector<std::string_view> paths;
  cuesta::tools::ScanOptions options;
  cuesta::tools::ScanOrder order = cuesta::tools::ScanOrder::first_use;
};

bool parse_number(std::string_view text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size();
}

bool parse(std::span<char*> words, Arguments& arguments) {
  bool sized = false;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    const auto number = [&](std::uint64_t& value) {
      return i + 1 < words.size() && parse_number(words[++i], value);
    };
    if (word == "--triangles") {
      if (!(sized = number(arguments.options.triangles))) return false;
    } else if (word == "--seed") {
      if (!number(arguments.options.seed)) return false;
    } else if (word == "--permute") {
      arguments.order = cuesta::tools::ScanOrder::permuted;
    } else if (word.starts_with("--")) {
      return false;
    } else {
      arguments.paths.push_back(word);
    }
  }
  return sized && arguments.paths.size() == 2;
}

int report(const cuesta::Error& error) {
  fmt::print(stderr, "cuesta-make-scan: {}\n", error.text());
  return cuesta::exit_status(error.code);
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (!parse(std::span(argv + 1, argv + argc), arguments)) {
    fmt::print(stderr, "{}", usage);
    return 1;
  }
  auto input = cuesta::load_mesh(arguments.paths[0], input_memory_bytes);
  if (!input) return report(input.error());
  auto scan = cuesta::tools::make_scan(*input, arguments.options);
  if (!scan) return report(scan.error());
  const auto written =
      cuesta::tools::write_scan(arguments.paths[1], *scan, arguments.order, arguments.options.seed);
  if (!written) return report(written.error());
  fmt::print("{}: {} triangles\n", arguments.paths[1], scan->triangles.size());
  return 0;
}
