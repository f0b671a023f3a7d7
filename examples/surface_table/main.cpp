#include "csrbf/core/error.hpp"
#include "csrbf/implicit/polygonize.hpp"
#include "csrbf/io/points.hpp"
#include "csrbf/surface/baselines/method_fit.hpp"
#include "csrbf/surface/reconstruct.hpp"
#include "csrbf/surface/surface_method.hpp"
#include "csrbf/surface/trim.hpp"

#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

namespace {

constexpr const char* usage =
    "usage: csrbf-surface-table CLOUD [--methods NAME,...] [--centers N] [--resolution N] [--time-limit SECONDS]\n\n"
    "Reconstructs the cloud with every method of reconstruct(), each in its own process, and prints a table: root\n"
    "mean square and 99th percentile of the distances from the points to the surface (relative to the diagonal),\n"
    "seconds to fit and to make the mesh, peak memory, connected components of the surface and how many of them\n"
    "contain data, Euler characteristic of the latter, and whether they are closed.\n";

struct Settings {
  std::string cloud;
  std::vector<std::string> methods;
  csrbf::Index centers = 0;
  int resolution = 96;
  unsigned time_limit = 600;
};

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::vector<std::string> split(const std::string& list) {
  std::vector<std::string> parts;
  std::istringstream stream(list);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

std::vector<std::string> all_methods() {
  std::vector<std::string> names = {"composite"};
  for (const csrbf::SurfaceMethod& method : csrbf::surface_methods()) names.emplace_back(method.name);
  return names;
}

// One line of the table but for the memory.
void print_row(const csrbf::PointCloud& cloud, const std::string& method, const Settings& settings) {
  const csrbf::Reconstruction surface = csrbf::reconstruct(cloud, {.method = method, .centers = settings.centers});
  const csrbf::ReconstructReport& report = surface.report;
  const auto start = std::chrono::steady_clock::now();
  csrbf::Mesh mesh = csrbf::polygonize(*surface.field, {.resolution = settings.resolution});
  const double mesh_seconds = seconds_since(start);
  const csrbf::Index components = csrbf::topology(mesh).components;
  mesh = csrbf::keep_components_with_data(std::move(mesh), cloud.points(Eigen::all, surface.source)).mesh;
  const csrbf::Topology topology = csrbf::topology(mesh);
  std::printf("| %-14s | %7lld | %8.2e | %8.2e | %7.2f | %7.2f | %5lld | %5lld | %5lld | %-6s ", method.c_str(),
              static_cast<long long>(report.centers), report.rms_distance, report.p99_distance, report.fit_seconds,
              mesh_seconds, static_cast<long long>(components), static_cast<long long>(topology.components),
              static_cast<long long>(topology.euler), topology.watertight() ? "yes" : "no");
}

// Runs a method in a child process, so that its memory and its failures are its own.
void run(const csrbf::PointCloud& cloud, const std::string& method, const Settings& settings) {
  std::fflush(stdout);
  const pid_t child = fork();
  if (child == 0) {
    alarm(settings.time_limit);
    int status = 0;
    try {
      print_row(cloud, method, settings);
    } catch (const std::exception& error) {
      std::printf("| %-14s | %s ", method.c_str(), error.what());
      status = 1;
    }
    std::fflush(stdout);
    _exit(status);
  }
  int status = 0;
  rusage use{};
  wait4(child, &status, 0, &use);
  if (!WIFEXITED(status)) std::printf("| %-14s | stopped after %u s ", method.c_str(), settings.time_limit);
  constexpr double kilobytes = 1024;
  std::printf("| %6.0f |\n", static_cast<double>(use.ru_maxrss) / kilobytes);
}

bool parse(int argc, char** argv, Settings& settings) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument[0] != '-') {
      settings.cloud = argument;
      continue;
    }
    if (i + 1 >= argc) return false;
    const std::string value = argv[++i];
    if (argument == "--methods")
      settings.methods = split(value);
    else if (argument == "--centers")
      settings.centers = std::atoll(value.c_str());
    else if (argument == "--resolution")
      settings.resolution = std::atoi(value.c_str());
    else if (argument == "--time-limit")
      settings.time_limit = static_cast<unsigned>(std::atoi(value.c_str()));
    else
      return false;
  }
  return !settings.cloud.empty();
}

}  // namespace

int main(int argc, char** argv) {
  Settings settings;
  if (argc == 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h")) {
    std::fputs(usage, stdout);
    return 0;
  }
  if (!parse(argc, argv, settings)) {
    std::fputs(usage, stderr);
    return 2;
  }
  if (settings.methods.empty()) settings.methods = all_methods();
  try {
    const csrbf::PointCloud cloud = csrbf::read_points(settings.cloud);
    std::printf(
        "| method         | centres |      rms |     99 %% | fit [s] | mesh [s] | comp. | data | euler | closed | MB "
        "|\n"
        "|---|---|---|---|---|---|---|---|---|---|---|\n");
    for (const std::string& method : settings.methods) run(cloud, method, settings);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-surface-table: %s\n", error.what());
    return 1;
  }
  return 0;
}
