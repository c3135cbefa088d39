#include "tools/importer/r_workspace.hpp"

#include <fmt/format.h>
#include <zlib.h>

#include <new>
#include <utility>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"

namespace aloft::importer {
namespace {

// The published workspaces unpack to about 1 MB; a file that unpacks to more than this is not one of them.
constexpr std::size_t max_unpacked_bytes = std::size_t{1} << 28U;

[[noreturn]] void refuse(const std::filesystem::path& file, std::string_view reason, std::string_view advice) {
  throw InputError("{}: {}. {}.", file.string(), reason, advice);
}

/// zlib's inflate over a byte string.
class Inflater {
 public:
  Inflater() {
    constexpr int gzip_only = 16 + MAX_WBITS;
    if (inflateInit2(&stream_, gzip_only) != Z_OK) throw std::bad_alloc();
  }
  ~Inflater() { inflateEnd(&stream_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  std::string unpack(const std::filesystem::path& file, std::string packed) {
    stream_.next_in = reinterpret_cast<Bytef*>(packed.data());
    stream_.avail_in = static_cast<uInt>(packed.size());
    std::string unpacked;
    std::string piece(std::size_t{1} << 16U, '\0');
    for (int status = Z_OK; status != Z_STREAM_END;) {
      stream_.next_out = reinterpret_cast<Bytef*>(piece.data());
      stream_.avail_out = static_cast<uInt>(piece.size());
      status = inflate(&stream_, Z_NO_FLUSH);
      unpacked.append(piece, 0, piece.size() - stream_.avail_out);
      if (status == Z_BUF_ERROR)
        refuse(file, fmt::format("the gzip data end too early, after {} bytes", packed.size()), download_again);
      if (status != Z_OK && status != Z_STREAM_END)
        refuse(file, fmt::format("the gzip data are damaged near byte {}", stream_.total_in), download_again);
      if (unpacked.size() > max_unpacked_bytes)
        refuse(file, fmt::format("it unpacks to more than {} MB", max_unpacked_bytes >> 20U),
               "The published workspaces are about 1 MB; name one of them");
    }
    return unpacked;
  }

 private:
  static constexpr std::string_view download_again = "The file is incomplete or altered: download it again";
  z_stream stream_{};
};

std::string unpack(std::string packed, const std::filesystem::path& file) {
  if (packed.rfind("\x1f\x8b", 0) != 0)
    refuse(file, packed.empty() ? "the file is empty" : "this is not a gzip file",
           "Give a workspace as R's save() writes it; one saved otherwise can be loaded and saved again in R with "
           "save(..., compress = \"gzip\")");
  std::string unpacked = Inflater().unpack(file, std::move(packed));
  const bool xdr = unpacked.rfind("RDX2\nX\n", 0) == 0 || unpacked.rfind("RDX3\nX\n", 0) == 0;
  if (!xdr)
    refuse(file, "the gzip data are no R workspace in XDR form (they do not begin with RDX2 or RDX3)",
           "Give a workspace as R's save() writes it");
  return unpacked;
}

}  // namespace

NumericVectors parse_r_workspace(std::string packed, const std::filesystem::path& file) {
  const std::string bytes = unpack(std::move(packed), file);
  try {
    return numeric_vectors(bytes);
  } catch (const UnreadableObjects& error) {
    refuse(file, fmt::format("the R workspace cannot be read: {}", error.what()),
           "Unless R reads it, the file is incomplete or altered: download it again");
  }
}

NumericVectors read_r_workspace(const std::filesystem::path& file) {
  return parse_r_workspace(read_file(file, max_unpacked_bytes), file);
}

}  // namespace aloft::importer
