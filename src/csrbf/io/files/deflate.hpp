#pragma once

#include <initializer_list>
#include <string>
#include <string_view>

namespace csrbf {

/// The first `size` bytes of the content of a gzip file (one or more members) or a zlib stream. Throws IoError with
/// `name` for damaged data and for streams that end earlier.
std::string inflate_bytes(std::string_view compressed, std::size_t size, const std::string& name);

/// The whole content of such a file. Throws IoError with `name` for damaged and truncated data.
std::string inflate_all(std::string_view compressed, const std::string& name);

/// At most `size` bytes from the beginning of the stream, to inspect a header. Throws IoError for damaged data.
std::string inflate_head(std::string_view compressed, std::size_t size, const std::string& name);

enum class DeflateFormat { zlib, gzip };

/// Compresses the parts, one after the other, to one stream, at zlib's level 3: a third of the time of the default
/// level for a few per cent more bytes.
std::string deflate_bytes(std::initializer_list<std::string_view> parts, DeflateFormat format);

}  // namespace csrbf
