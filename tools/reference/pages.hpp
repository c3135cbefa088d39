#pragma once

#include <string>
#include <vector>

namespace aloft::reference {

struct Page {
  std::string file;  ///< in docs/reference/
  std::string text;
};

/// The reference pages, as Markdown, from the tables that the programs themselves go by.
[[nodiscard]] std::vector<Page> pages();

/// The page on a database made by this SQL: a comment behind "(" tells of the table, one behind a column of that
/// column. Throws std::logic_error where one is missing.
[[nodiscard]] std::string database_page(const std::string& sql, int version);

}  // namespace aloft::reference
