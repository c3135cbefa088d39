// Every Markdown document as readers see it: tables show as tables, links have targets, named files exist.
#include <algorithm>
#include <catch2/catch.hpp>
#include <regex>
#include <sstream>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"
#include "tests/project/markdown.hpp"

namespace fs = std::filesystem;
using namespace aloft::test;

namespace {

bool well_formed_address(const std::string& target) {
  static const std::regex address(
      R"((https?://[A-Za-z0-9.-]+(:[0-9]+)?(/[^\s<>"]*)?)|(mailto:[^\s@]+@[A-Za-z0-9.-]+))");
  return std::regex_match(target, address);
}

bool is_address(const std::string& target) {
  return target.find("://") != std::string::npos || target.starts_with("mailto:");
}

const Document* document_at(const std::vector<Document>& documents, const fs::path& file) {
  const auto found =
      std::find_if(documents.begin(), documents.end(), [&](const Document& other) { return other.file == file; });
  return found == documents.end() ? nullptr : &*found;
}

/// Why the target of a link in `document` does not exist; empty if it exists.
std::string dead_end(const Document& document, const std::string& target, const std::vector<Document>& all) {
  if (is_address(target)) return well_formed_address(target) ? "" : "no well-formed address";
  const std::size_t hash = target.find('#');
  const std::string path = target.substr(0, hash);
  const fs::path file = path.empty() ? document.file : (document.file.parent_path() / path).lexically_normal();
  if (!path.empty() && !fs::exists(file)) return "there is no such file";
  if (hash == std::string::npos) return "";
  const Document* other = path.empty() ? &document : document_at(all, file);
  if (other == nullptr) return "anchors are known of Markdown documents only";
  return other->anchors.contains(target.substr(hash + 1)) ? "" : "there is no such heading";
}

/// True for paths such as "common/bus" and "tools/test.sh", but not for files called x, which are placeholders.
bool is_path_of_checkout(const std::string& text) {
  static const std::regex path(R"((bench|common|data|deploy|docs|idl|services|tests|tools)/[A-Za-z0-9_./-]*)");
  return std::regex_match(text, path) && fs::path(text).stem() != "x";
}

/// Words of a line of shell code without its comment. Brace lists and wildcards are not checked.
std::vector<std::string> words_of(const std::string& line) {
  std::vector<std::string> words;
  std::istringstream stream(line.substr(0, line.find(" #")));
  for (std::string word; stream >> word;) words.push_back(word);
  return words;
}

/// Paths that `document` names in its code but that are not in the checkout.
std::vector<Located> missing_paths(const Document& document) {
  std::vector<Located> named = document.code_spans;
  for (const CodeBlock& block : document.code_blocks)
    if (block.language == "sh")
      for (std::size_t i = 0; i < block.code.size(); ++i)
        named.push_back({block.line + static_cast<int>(i), block.code[i]});
  std::vector<Located> missing;
  for (const Located& code : named)
    for (const std::string& word : words_of(code.text))
      if (is_path_of_checkout(word) && !fs::exists(source_dir() / word) &&
          !fs::exists(document.file.parent_path() / word))
        missing.push_back({code.line, word});
  return missing;
}

/// All faults of `document`, one per line.
std::vector<std::string> problems_of(const Document& document, const std::vector<Document>& all) {
  std::vector<std::string> problems;
  const auto note = [&](int line, const std::string& what) {
    problems.push_back(document.file.lexically_relative(source_dir()).string() + ":" + std::to_string(line) + ": " +
                       what);
  };
  for (const Located& table : document.broken_tables) note(table.line, table.text);
  for (const auto* targets : {&document.links, &document.images})
    for (const Located& target : *targets)
      if (const std::string why = dead_end(document, target.text, all); !why.empty())
        note(target.line, target.text + ": " + why);
  for (const Located& path : missing_paths(document)) note(path.line, path.text + ": there is no such file");
  return problems;
}

}  // namespace

TEST_CASE("tables, links, images and named files of all documents are in order") {
  const std::vector<Document> documents = all_documents();
  int tables = 0;
  std::size_t links = 0;
  for (const Document& document : documents) {
    tables += document.tables;
    links += document.links.size();
    for (const std::string& problem : problems_of(document, documents)) FAIL_CHECK(problem);
  }
  CHECK(documents.size() > 15);
  CHECK(tables > 30);
  CHECK(links > 20);
}

TEST_CASE("the faults of a document are found, with their lines") {
  const Document document = parse_document(source_dir() / "docs/made-up.md", R"(# A heading: *really*, `twice`
# A heading: really, twice
| no | delimiter |
| 1 | 2 |

| a | b |
|---|---|
| 1 | 2 | 3 |
| `x \| y` | 2 |

[one](architecture.md) [two](nowhere.md) [three](architecture.md#on-the-wire) [four](architecture.md#on-the-moon)
[five](#a-heading-really-twice-1) [six](#a-heading) ![seven](images/none.svg) [eight](https://a.b/c) [nine](http://a_b)
`common/bus` `common/buzz` `data/experiments/quick.json`
)");
  const std::vector<std::string> problems = problems_of(document, all_documents());
  CHECK(problems == std::vector<std::string>{
                        "docs/made-up.md:3: the rows of a table show as a paragraph",
                        "docs/made-up.md:8: a row with more or fewer cells than the heading of its table",
                        "docs/made-up.md:11: nowhere.md: there is no such file",
                        "docs/made-up.md:11: architecture.md#on-the-moon: there is no such heading",
                        "docs/made-up.md:12: #a-heading: there is no such heading",
                        "docs/made-up.md:12: http://a_b: no well-formed address",
                        "docs/made-up.md:12: images/none.svg: there is no such file",
                        "docs/made-up.md:13: common/buzz: there is no such file",
                    });
}
