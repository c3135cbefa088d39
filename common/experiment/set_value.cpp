#include "common/experiment/set_value.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "common/base/error.hpp"
#include "common/base/json_text.hpp"
#include "common/base/nearest.hpp"
#include "common/base/number_text.hpp"
#include "common/base/plain_text.hpp"

namespace aloft::experiment {
namespace {

using OrderedJson = nlohmann::ordered_json;

std::vector<std::string> split(const std::string& path) {
  std::vector<std::string> keys;
  for (std::size_t start = 0; start <= path.size();) {
    const std::size_t dot = std::min(path.find('.', start), path.size());
    keys.push_back(path.substr(start, dot - start));
    start = dot + 1;
  }
  return keys;
}

OrderedJson as_value(const std::string& text, const std::string& assignment) {
  OrderedJson value =
      OrderedJson::accept(text) ? parse_json(text, fmt::format("--set {}", excerpt(assignment))) : OrderedJson(text);
  try {
    (void)value.dump();
  } catch (const OrderedJson::exception&) {
    throw InputError("--set {}: the value is not UTF-8 text", excerpt(assignment));
  }
  return value;
}

std::vector<std::string> keys_of(const OrderedJson& object) {
  std::vector<std::string> keys;
  for (const auto& item : object.items()) keys.push_back(item.key());
  return keys;
}

/// One step down the path; `seen` is the path so far.
OrderedJson& child(OrderedJson& node, const std::string& key, const std::string& seen, bool last) {
  const std::string parent = seen.empty() ? "the file" : fmt::format("'{}'", excerpt(seen));
  if (node.is_array()) {
    const auto index = number_in<std::size_t>(key);
    if (!index || *index >= node.size())
      throw InputError(node.empty() ? fmt::format("{} is an empty list", parent)
                                    : fmt::format("{} has no entry '{}'; use a number from 0 to {}", parent,
                                                  excerpt(key), node.size() - 1));
    return node[*index];
  }
  if (!node.is_object())
    throw InputError("{} is {}, which has no '{}' in it", parent, excerpt(node.dump()), excerpt(key));
  if (!last && !node.contains(key))
    throw InputError("{} has no '{}'.{}", parent, excerpt(key), did_you_mean(key, keys_of(node)));
  return node[key];
}

}  // namespace

void set_value(OrderedJson& document, const std::string& assignment) {
  const std::size_t equals = assignment.find('=');
  if (equals == 0 || equals == std::string::npos)
    throw InputError("--set {}: use json.path=value, e.g. world.bs_density_per_km2=5", excerpt(assignment));
  const std::vector<std::string> keys = split(assignment.substr(0, equals));
  OrderedJson* node = &document;
  std::string seen;
  try {
    for (std::size_t i = 0; i < keys.size(); ++i) {
      // An agent given by its name alone becomes an object when one of its parameters is set.
      if (node->is_string() && i == 2 && keys[0] == "agents") *node = {{"type", node->get<std::string>()}};
      node = &child(*node, keys[i], seen, i + 1 == keys.size());
      seen += (seen.empty() ? "" : ".") + keys[i];
    }
  } catch (const InputError& error) {
    throw InputError("--set {}: {}", excerpt(assignment), error.what());
  }
  *node = as_value(assignment.substr(equals + 1), assignment);
}

}  // namespace aloft::experiment
