#pragma once

#include <string>

namespace bench {

/// Empty, or what is wrong with "FIRST..LAST".
[[nodiscard]] std::string fault_of_widths(const std::string& text);

/// Training of networks as the paper's with other widths of the hidden layers: each path of this CPU that learns,
/// beside its floor and beside what the network's arrays take of each cache.
void print_widths(const std::string& widths);

}  // namespace bench
