#include "csrbf/implicit/render.hpp"

#include "commands/commands.hpp"

#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/io/mesh.hpp"
#include "csrbf/io/model.hpp"
#include "csrbf/io/volume.hpp"

#include <tuple>
#include <utility>

namespace csrbf::app {
namespace {

constexpr std::string_view error_prefix = "error:";

std::pair<int, int> parse_picture_size(const std::string& text) {
  const Eigen::VectorXd numbers = parse_numbers(text, 'x', 2, "--size");
  constexpr double largest = 32768;  // pixels; keeps an image below 4 GB
  if ((numbers.array() != numbers.array().round()).any() || numbers.minCoeff() < 1 || numbers.maxCoeff() > largest)
    throw UsageError("--size " + text + ": expected WIDTHxHEIGHT in pixels, at most 32768 each");
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

RenderColor parse_color(const std::string& text) {
  if (text.starts_with(error_prefix)) return RenderColor::error;
  for (const auto& [name, color] : {std::pair("plain", RenderColor::plain), std::pair("normal", RenderColor::normal),
                                    std::pair("mean-curvature", RenderColor::mean_curvature),
                                    std::pair("gaussian-curvature", RenderColor::gaussian_curvature)})
    if (text == name) return color;
  throw UsageError("--color " + text +
                   ": unknown; use plain, normal, mean-curvature, gaussian-curvature or error:REFERENCE");
}

UpAxis parse_up(const std::string& text) {
  if (text == "x") return UpAxis::x;
  return text == "y" ? UpAxis::y : UpAxis::z;
}

RenderOptions make_render_options(const RenderCommand& command) {
  RenderOptions options;
  std::tie(options.width, options.height) = parse_picture_size(command.size);
  const Eigen::VectorXd view = parse_numbers(command.view, ',', 2, "--view");
  options.view = {view[0], view[1]};
  options.up = parse_up(command.up);
  options.color = parse_color(command.color);
  return options;
}

}  // namespace

void run(const RenderCommand& command, Session& session) {
  RenderOptions options = make_render_options(command);
  options.progress = session.progress();
  session.expect_output("--output", command.output, ".png", "pictures");
  session.input = {{"file", command.input}};
  session.options = {{"output", command.output},
                     {"size", {options.width, options.height}},
                     {"view", options.view},
                     {"up", command.up},
                     {"color", command.color}};

  Mesh reference;
  if (options.color == RenderColor::error) {
    reference = session.timed("read", [&] { return read_mesh(command.color.substr(error_prefix.size())); });
    options.reference = &reference;
  }
  RgbImage image;
  if (file_extension(command.input) == ".csrbf" || is_volume_file(command.input)) {  // read_model() says why not
    const std::shared_ptr<const Field<3>> field = session.timed("read", [&] { return read_model(command.input); });
    image = session.timed("render", [&] { return render(*field, options); });
  } else {
    const Mesh mesh = session.timed("read", [&] { return read_mesh(command.input); });
    image = session.timed("render", [&] { return render(mesh, options); });
  }
  session.result = {{"width", image.width}, {"height", image.height}};
  session.say(command.output + ": " + std::to_string(image.width) + " x " + std::to_string(image.height) + " pixels");
  session.write([&] { write_png(command.output, image); });
}

}  // namespace csrbf::app
