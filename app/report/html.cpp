#include "report/html.hpp"

#include "csrbf/io/images/formats.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

namespace csrbf::app {

std::string escaped(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  using Entity = std::pair<char, std::string_view>;
  constexpr std::array<Entity, 5> entities{
      {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}, {'\'', "&#39;"}}};
  for (const char c : text) {
    const auto* entity = std::find_if(entities.begin(), entities.end(), [&](const Entity& e) { return e.first == c; });
    // Other control characters are invalid in a document; a report must not fail because of a file name.
    const char kept = static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t' ? '?' : c;
    result += entity != entities.end() ? entity->second : std::string_view(&kept, 1);
  }
  return result;
}

std::string base64(std::string_view bytes) {
  constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  const auto byte = [&](std::size_t i) { return std::uint32_t{static_cast<std::uint8_t>(bytes[i])}; };
  std::string result((bytes.size() + 2) / 3 * 4, '=');
  char* out = result.data();
  std::size_t i = 0;
  for (; i + 2 < bytes.size(); i += 3) {
    const std::uint32_t group = byte(i) << 16 | byte(i + 1) << 8 | byte(i + 2);
    for (int shift = 18; shift >= 0; shift -= 6) *out++ = digits[group >> shift & 63U];
  }
  const std::size_t rest = bytes.size() - i;
  if (rest == 0) return result;
  const std::uint32_t group = byte(i) << 16 | (rest == 2 ? byte(i + 1) << 8 : 0U);
  for (std::size_t k = 0; k <= rest; ++k) *out++ = digits[group >> (18 - 6 * k) & 63U];
  return result;
}

std::string png_address(const RgbImage& picture) {
  VolumeLayout layout;
  layout.grid.axes = 2;
  layout.grid.size = {picture.width, picture.height, 1};
  layout.components = 3;
  layout.type = SampleType::uint8;
  const std::string_view samples(reinterpret_cast<const char*>(picture.pixels.data()), picture.pixels.size());
  return "data:image/png;base64," + base64(format_png(layout, samples, "picture of the report").head);
}

std::string picture_element(const RgbImage& picture, std::string_view description) {
  return "<img src=\"" + png_address(picture) + "\" width=\"" + std::to_string(picture.width) + "\" height=\"" +
         std::to_string(picture.height) + "\" alt=\"" + escaped(description) + "\">";
}

std::string script_text(const nlohmann::ordered_json& data) {
  std::string text = data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  constexpr std::string_view escape = "\\u003c";
  for (std::size_t at = text.find('<'); at != std::string::npos; at = text.find('<', at + escape.size()))
    text.replace(at, 1, escape);
  return text;
}

std::string coordinate(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  std::string result = text.data();
  while (result.ends_with('0')) result.pop_back();
  if (result.ends_with('.')) result.pop_back();
  return result == "-0" ? "0" : result;
}

}  // namespace csrbf::app
