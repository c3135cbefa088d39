#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace aloft {

/// SHA-256 (OpenSSL) of everything added, as 64 hexadecimal digits.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;

  void add(std::string_view bytes);
  /// Ends the digest; call once.
  [[nodiscard]] std::string hex();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

[[nodiscard]] std::string sha256_hex(std::string_view bytes);

/// Throws InputError, ending in `advice`, if `bytes`, the content of `file`, do not have the digest `sha256` that was
/// noted when the experiment was resolved. An empty `sha256` accepts any content.
void check_unchanged(const std::filesystem::path& file, std::string_view bytes, std::string_view sha256,
                     std::string_view advice);

/// The first 64 bits of the SHA-256, which are used as ids.
[[nodiscard]] std::uint64_t sha256_id(std::string_view bytes);

}  // namespace aloft
