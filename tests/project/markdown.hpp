#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace aloft::test {

/// A piece of a document, and its line.
struct Located {
  int line = 0;
  std::string text;
};

struct CodeBlock {
  int line = 0;  ///< of its first line of code
  std::string language;
  std::vector<std::string> code;  ///< line by line
};

/// What a Markdown document holds, as GitHub's own renderer (cmark-gfm) reads it.
struct Document {
  std::filesystem::path file;
  std::vector<Located> links;       ///< targets, as they are written
  std::vector<Located> images;      ///< likewise
  std::vector<Located> code_spans;  ///< `like this`
  std::vector<CodeBlock> code_blocks;
  std::set<std::string> anchors;  ///< of the headings, as GitHub makes them
  int tables = 0;
  std::vector<Located> broken_tables;  ///< the fault of each table that does not show as meant
};

[[nodiscard]] Document parse_document(const std::filesystem::path& file, const std::string& text);

/// All Markdown documents of the checkout.
[[nodiscard]] std::vector<Document> all_documents();

}  // namespace aloft::test
