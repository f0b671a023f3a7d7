// The commands of the smaller program: those about surfaces. A page that makes a surface downloads no more than this.
#include "commands/commands.hpp"

namespace csrbf::app {
namespace {

template <class AnyCommand, class... Known>
constexpr bool is_one_of = (std::is_same_v<AnyCommand, Known> || ...);

template <class AnyCommand>
constexpr bool is_about_surfaces = is_one_of<AnyCommand, ReconstructCommand, EstimateNormalsCommand, PolygonizeCommand,
                                             RenderCommand, CurvatureCommand, CombineCommand, CompareCommand>;

}  // namespace

void run(const Command& command, Session& session) {
  const auto run_one = [&]<class AnyCommand>(const AnyCommand& chosen) {
    if constexpr (is_about_surfaces<AnyCommand>)
      run(chosen, session);
    else
      throw UsageError("this command is in the larger program");
  };
  std::visit(run_one, command);
}

}  // namespace csrbf::app
