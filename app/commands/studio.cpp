#include "commands/command_flags.hpp"
#include "inputs/bytes.hpp"
#include "studio/server.hpp"

namespace csrbf::app {

void declare(CommandFlags& v, StudioCommand& c) {
  v.argument("FILES", c.inputs, "points, meshes, tables, images, volumes and models to begin with")->required(false);
  constexpr int most = 65535;
  v.flag("port", c.port, "N", "a free one", "port on this machine, 127.0.0.1; others cannot reach it")
      ->check(CLI::Range(0, most));
  v.toggle("--no-browser", c.no_browser, "print the address, and open no browser");
  v.flag(
      "folder", c.folder, "DIR", "a temporary one",
      "folder to work in: its files can be opened, results stay there; without it results are lost in the end unless "
      "they are saved from the page");
  v.flag("largest", c.largest, "SIZE", "4GB", "largest file that can be dropped on the page");
}

void run(const StudioCommand& command, Session& session) {
  session.options = {{"port", command.port},
                     {"no_browser", command.no_browser},
                     {"folder", or_null(command.folder)},
                     {"largest", command.largest}};
  session.input = {{"files", command.inputs}};
  serve_studio({.files = command.inputs,
                .port = command.port,
                .opens_browser = !command.no_browser,
                .folder = command.folder,
                .largest = parse_bytes(command.largest, "--largest")});
}

}  // namespace csrbf::app
