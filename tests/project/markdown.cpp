#include "tests/project/markdown.hpp"

#include <cmark-gfm-core-extensions.h>
#include <cmark-gfm.h>

#include <algorithm>
#include <cctype>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "tests/integration/command.hpp"
#include "tests/paths.hpp"

namespace aloft::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string literal(cmark_node* node) {
  const char* text = cmark_node_get_literal(node);
  return text == nullptr ? "" : text;
}

/// The text inside `node`, without its mark-up.
std::string plain_text(cmark_node* node) {
  std::string text = literal(node);
  for (cmark_node* child = cmark_node_first_child(node); child != nullptr; child = cmark_node_next(child))
    text += plain_text(child);
  return text;
}

/// The line of the nearest block, since inline nodes and a paragraph just above a table have none.
int line_of(cmark_node* node) {
  while (node != nullptr && cmark_node_get_start_line(node) == 0)
    node = cmark_node_next(node) != nullptr && cmark_node_get_start_line(cmark_node_next(node)) != 0
               ? cmark_node_next(node)
               : cmark_node_parent(node);
  return node == nullptr ? 0 : cmark_node_get_start_line(node);
}

/// The anchor of a heading: lower case, hyphens for spaces, no punctuation, and a number if it occurred before.
std::string anchor_of(const std::string& heading, const std::set<std::string>& taken) {
  std::string anchor;
  for (const char c : heading) {
    const auto byte = static_cast<unsigned char>(c);
    if (c == ' ')
      anchor += '-';
    else if (byte >= 0x80 || std::isalnum(byte) != 0 || c == '-' || c == '_')
      anchor += static_cast<char>(byte < 0x80 ? std::tolower(byte) : byte);
  }
  if (!taken.contains(anchor)) return anchor;
  int number = 1;
  while (taken.contains(anchor + "-" + std::to_string(number))) ++number;
  return anchor + "-" + std::to_string(number);
}

/// Number of bars that separate cells, which are those without a backslash before them.
std::ptrdiff_t bars_in(const std::string& line) {
  std::ptrdiff_t bars = std::count(line.begin(), line.end(), '|');
  for (std::size_t at = 0; (at = line.find("\\|", at)) != std::string::npos; ++at) --bars;
  return bars;
}

/// Finds rows whose number of cells differs from the heading's; the renderer silently drops or adds cells.
void check_table(cmark_node* table, const std::vector<std::string>& lines, Document& document) {
  ++document.tables;
  std::ptrdiff_t columns = 0;
  for (int line = cmark_node_get_start_line(table); line <= cmark_node_get_end_line(table); ++line) {
    const std::ptrdiff_t bars = bars_in(lines.at(static_cast<std::size_t>(line) - 1));
    if (columns == 0) columns = bars;  // a table node includes text just above the table
    if (bars != columns)
      document.broken_tables.push_back({line, "a row with more or fewer cells than the heading of its table"});
  }
}

/// Finds tables without a delimiter row, which show as a paragraph.
void check_paragraph(cmark_node* paragraph, Document& document) {
  bool begins = true;
  for (cmark_node* part = cmark_node_first_child(paragraph); part != nullptr; part = cmark_node_next(part)) {
    if (begins && literal(part).starts_with('|')) {
      document.broken_tables.push_back({line_of(paragraph), "the rows of a table show as a paragraph"});
      return;
    }
    begins = cmark_node_get_type(part) == CMARK_NODE_SOFTBREAK;
  }
}

void take(cmark_node* node, const std::vector<std::string>& lines, Document& document) {
  const cmark_node_type type = cmark_node_get_type(node);
  const auto located = [&](std::string text) { return Located{line_of(node), std::move(text)}; };
  if (type == CMARK_NODE_LINK) document.links.push_back(located(cmark_node_get_url(node)));
  if (type == CMARK_NODE_IMAGE) document.images.push_back(located(cmark_node_get_url(node)));
  if (type == CMARK_NODE_CODE) document.code_spans.push_back(located(literal(node)));
  if (type == CMARK_NODE_CODE_BLOCK)
    document.code_blocks.push_back({line_of(node) + 1, cmark_node_get_fence_info(node), lines_of(literal(node))});
  if (type == CMARK_NODE_HEADING) document.anchors.insert(anchor_of(plain_text(node), document.anchors));
  if (type == CMARK_NODE_PARAGRAPH) check_paragraph(node, document);
  if (std::string_view(cmark_node_get_type_string(node)) == "table") check_table(node, lines, document);
}

}  // namespace

Document parse_document(const fs::path& file, const std::string& text) {
  cmark_gfm_core_extensions_ensure_registered();
  const std::unique_ptr<cmark_parser, decltype(&cmark_parser_free)> parser(cmark_parser_new(CMARK_OPT_DEFAULT),
                                                                           cmark_parser_free);
  for (const char* name : {"table", "strikethrough", "autolink"}) {
    cmark_syntax_extension* extension = cmark_find_syntax_extension(name);
    if (extension == nullptr) throw std::runtime_error(std::string("cmark-gfm has no extension ") + name);
    cmark_parser_attach_syntax_extension(parser.get(), extension);
  }
  cmark_parser_feed(parser.get(), text.data(), text.size());
  const std::unique_ptr<cmark_node, decltype(&cmark_node_free)> root(cmark_parser_finish(parser.get()),
                                                                     cmark_node_free);
  const std::unique_ptr<cmark_iter, decltype(&cmark_iter_free)> walk(cmark_iter_new(root.get()), cmark_iter_free);
  Document document;
  document.file = file;
  const std::vector<std::string> lines = lines_of(text);
  for (cmark_event_type event = cmark_iter_next(walk.get()); event != CMARK_EVENT_DONE;
       event = cmark_iter_next(walk.get()))
    if (event == CMARK_EVENT_ENTER) take(cmark_iter_get_node(walk.get()), lines, document);
  return document;
}

std::vector<Document> all_documents() {
  std::vector<Document> documents;
  for (auto entry = fs::recursive_directory_iterator(source_dir()); entry != fs::end(entry); ++entry) {
    const std::string name = entry->path().filename().string();
    const bool not_ours =
        name.starts_with("build") || name.starts_with('.') || name == "results" || name == "node_modules";
    if (entry->is_directory() && not_ours) entry.disable_recursion_pending();
    if (entry->path().extension() == ".md")
      documents.push_back(parse_document(entry->path(), read_text(entry->path())));
  }
  std::sort(documents.begin(), documents.end(), [](const Document& a, const Document& b) { return a.file < b.file; });
  return documents;
}

}  // namespace aloft::test
