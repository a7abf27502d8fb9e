#pragma once
/// The tables that benches write, read again to be drawn: cells without quotes.

#include <algorithm>
#include <istream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace cuesta::bench {

using Row = std::map<std::string, std::string>;  ///< column → cell

inline std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream in(line);
  for (std::string cell; std::getline(in, cell, ',');) cells.push_back(cell);
  return cells;
}

/// Rows below the first line, which names the columns.
inline std::vector<Row> rows_of(std::istream& in) {
  std::vector<Row> rows;
  std::string line;
  std::getline(in, line);
  const auto names = cells_of(line);
  while (std::getline(in, line)) {
    const auto cells = cells_of(line);
    Row row;
    for (std::size_t i = 0; i < std::min(names.size(), cells.size()); ++i) row[names[i]] = cells[i];
    rows.push_back(row);
  }
  return rows;
}

}  // namespace cuesta::bench
