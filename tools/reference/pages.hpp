#pragma once

#include <string>
#include <vector>

namespace aloft::reference {

struct Page {
  std::string file;  ///< in docs/reference/
  std::string text;
};

/// The reference pages in Markdown, made from the tables that the programs use.
[[nodiscard]] std::vector<Page> pages();

/// The page on a database made by this SQL. A comment behind "(" describes the table, one behind a column that column.
/// Throws std::logic_error where one is missing.
[[nodiscard]] std::string database_page(const std::string& sql, int version);

}  // namespace aloft::reference
