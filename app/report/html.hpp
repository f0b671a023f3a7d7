#pragma once

#include "csrbf/core/image.hpp"

#include <nlohmann/json.hpp>

#include <string>
#include <string_view>

namespace csrbf::app {

/// Text escaped for HTML and SVG, also within the quotes of an attribute.
std::string escaped(std::string_view text);

/// Base64 (RFC 4648) of any bytes.
std::string base64(std::string_view bytes);

/// The picture as a data URL: data:image/png;base64,...
std::string png_address(const RgbImage& picture);

/// An element that shows the picture; `description` is its alternative text.
std::string picture_element(const RgbImage& picture, std::string_view description);

/// Data for a script of the page: JSON that cannot close the script element.
std::string script_text(const nlohmann::ordered_json& data);

/// A coordinate in a drawing: two decimals, without trailing zeros.
std::string coordinate(double value);

}  // namespace csrbf::app
