#include <fmt/format.h>

#include <sstream>
#include <stdexcept>
#include <utility>

#include "tools/reference/markdown_table.hpp"
#include "tools/reference/pages.hpp"

namespace aloft::reference {
namespace {

/// Splits a line into its SQL and its comment.
std::pair<std::string, std::string> split(const std::string& line) {
  const std::size_t dashes = line.find("--");
  std::string sql = line.substr(0, dashes);
  sql.erase(0, sql.find_first_not_of(' '));
  sql.erase(sql.find_last_not_of(" ,(") + 1);
  return {sql, dashes == std::string::npos ? "" : line.substr(line.find_first_not_of("- ", dashes))};
}

std::string described(const std::string& line, const std::string& comment) {
  if (comment.empty()) throw std::logic_error(fmt::format("no comment tells what this is: {}", line));
  return cell(comment);
}

}  // namespace

std::string database_page(const std::string& sql, int version) {
  std::string text = fmt::format(
      "# The database of a run\n{}\n"
      "`results.sqlite` in every result folder holds all flights of a run. It is an ordinary SQLite database, "
      "format {} (`PRAGMA user_version`); read it with\n"
      "any program at any time, and leave writing to Aloft. Tables of steps and of flights, as text: `aloft export`.\n",
      made_by, version);
  std::istringstream lines(sql);
  for (std::string line; std::getline(lines, line);) {
    const auto [code, comment] = split(line);
    if (const std::size_t table = code.find("TABLE "); table != std::string::npos)
      text += fmt::format("\n## {}\n{}\n\n| column | type | holds |\n|---|---|---|\n", code.substr(code.rfind(' ') + 1),
                          described(line, comment));
    else if (code.starts_with("PRIMARY KEY"))
      text += fmt::format("\n{}.\n", code);
    else if (const std::size_t space = code.find(' '); space != std::string::npos && !code.starts_with(')'))
      text += fmt::format("| `{}` | {} | {} |\n", code.substr(0, space), cell(code.substr(space + 1)),
                          described(line, comment));
  }
  return text;
}

}  // namespace aloft::reference
