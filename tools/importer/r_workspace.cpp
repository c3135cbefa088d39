#include "tools/importer/r_workspace.hpp"

#include <fmt/format.h>
#include <rdata/rdata.h>
#include <zlib.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>

#include "common/base/error.hpp"
#include "common/base/read_file.hpp"

namespace aloft::importer {
namespace {

// The published workspaces unpack to about 1 MB; a file that unpacks to more than this is not one of them.
constexpr std::size_t max_unpacked_bytes = std::size_t{1} << 28U;

[[noreturn]] void refuse(const std::filesystem::path& file, std::string_view reason, std::string_view advice) {
  throw InputError(fmt::format("{}: {}. {}.", file.string(), reason, advice));
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

std::string unpack(const std::filesystem::path& file) {
  std::string packed = read_file(file, max_unpacked_bytes);
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

/// State of librdata's callbacks, which read from `bytes` and fill `vectors`.
struct Reading {
  std::string bytes;
  std::size_t position = 0;
  NumericVectors vectors;
  std::string error;
};

Reading& reading(void* context) {
  return *static_cast<Reading*>(context);
}

int open_bytes(const char* /*path*/, void* context) {
  reading(context).position = 0;
  return 0;
}

int close_bytes(void* /*context*/) {
  return 0;
}

rdata_off_t seek_bytes(rdata_off_t offset, rdata_io_flags_t whence, void* context) {
  Reading& source = reading(context);
  const std::size_t base = whence == RDATA_SEEK_SET   ? 0
                           : whence == RDATA_SEEK_CUR ? source.position
                                                      : source.bytes.size();
  const rdata_off_t target = static_cast<rdata_off_t>(base) + offset;
  if (target < 0 || static_cast<std::size_t>(target) > source.bytes.size()) return -1;
  source.position = static_cast<std::size_t>(target);
  return target;
}

ssize_t read_some(void* buffer, std::size_t size, void* context) {
  Reading& source = reading(context);
  const std::size_t count = std::min(size, source.bytes.size() - source.position);
  std::memcpy(buffer, source.bytes.data() + source.position, count);
  source.position += count;
  return static_cast<ssize_t>(count);
}

int keep_vector(const char* name, rdata_type_t type, void* data, long count, void* context) {
  if (name == nullptr || data == nullptr || count < 0) return 0;
  std::vector<double> values(static_cast<std::size_t>(count));
  if (type == RDATA_TYPE_REAL) {
    std::memcpy(values.data(), data, values.size() * sizeof(double));
  } else if (type == RDATA_TYPE_INT32) {
    constexpr std::int32_t r_missing = std::numeric_limits<std::int32_t>::min();
    std::vector<std::int32_t> whole(values.size());
    std::memcpy(whole.data(), data, whole.size() * sizeof(std::int32_t));
    std::transform(whole.begin(), whole.end(), values.begin(), [](std::int32_t value) {
      return value == r_missing ? std::numeric_limits<double>::quiet_NaN() : static_cast<double>(value);
    });
  } else {
    return 0;
  }
  reading(context).vectors[name] = std::move(values);
  return 0;
}

void note_error(const char* message, void* context) {
  reading(context).error = message;
}

}  // namespace

NumericVectors read_r_workspace(const std::filesystem::path& file) {
  Reading source;
  source.bytes = unpack(file);
  const std::unique_ptr<rdata_parser_t, decltype(&rdata_parser_free)> parser(rdata_parser_init(), &rdata_parser_free);
  if (!parser) throw std::bad_alloc();
  rdata_set_open_handler(parser.get(), open_bytes);
  rdata_set_close_handler(parser.get(), close_bytes);
  rdata_set_seek_handler(parser.get(), seek_bytes);
  rdata_set_read_handler(parser.get(), read_some);
  std::free(parser->io->io_ctx);  // librdata does not free this itself
  rdata_set_io_ctx(parser.get(), &source);
  rdata_set_column_handler(parser.get(), keep_vector);
  rdata_set_error_handler(parser.get(), note_error);
  const rdata_error_t status = rdata_parse(parser.get(), file.c_str(), &source);
  if (status != RDATA_OK)
    refuse(file,
           fmt::format("the R workspace cannot be read ({}{}{})", rdata_error_message(status),
                       source.error.empty() ? "" : "; ", source.error),
           "The file is incomplete or altered, or not saved by R: download it again");
  return std::move(source.vectors);
}

}  // namespace aloft::importer
