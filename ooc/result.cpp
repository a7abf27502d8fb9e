#include "ooc/result.h"

#include <array>

namespace cuesta {
namespace {

struct CodeRow {
  std::string_view name;
  int exit_status;
};

constexpr std::array<CodeRow, 7> code_table{{{"not found", 2},
                                             {"corrupt", 3},
                                             {"unsupported", 4},
                                             {"invalid input", 5},
                                             {"input/output error", 6},
                                             {"out of budget", 7},
                                             {"cancelled", 8}}};

}  // namespace

std::string_view name(ErrorCode code) {
  return code_table.at(static_cast<std::size_t>(code)).name;
}

int exit_status(ErrorCode code) {
  return code_table.at(static_cast<std::size_t>(code)).exit_status;
}

std::string Error::text() const {
  std::string out;
  if (!file.empty()) out += file + ": ";
  if (!place.empty()) out += place + ": ";
  out += message;
  out += " (";
  out += name(code);
  out += ")";
  return out;
}

}  // namespace cuesta
