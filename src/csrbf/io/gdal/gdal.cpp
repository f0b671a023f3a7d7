#include "csrbf/io/gdal/gdal.hpp"

#include "csrbf/core/error.hpp"
#include "csrbf/io/files/atomic_file.hpp"
#include "csrbf/io/files/read_file.hpp"
#include "csrbf/io/files/text.hpp"

#ifndef _WIN32
#include <dlfcn.h>
#endif

#include <filesystem>

namespace csrbf {
namespace {

namespace fs = std::filesystem;

#define CSRBF_TEXT_OF(name) #name
#define CSRBF_TEXT(name) CSRBF_TEXT_OF(name)

#ifdef _WIN32

const GdalFunctions* load() {
  return nullptr;
}

#else

// The file that this code is in: a program, or a shared library.
fs::path own_file() {
  Dl_info info{};
  std::error_code error;
  const bool known = dladdr(reinterpret_cast<const void*>(&gdal_version), &info) != 0 && info.dli_fname != nullptr;
  const fs::path file = known ? info.dli_fname : "";
  if (file.has_parent_path() && fs::exists(file, error)) return fs::canonical(file, error);
  return fs::read_symlink("/proc/self/exe", error);
}

// Beside the library, below its folder, and where programs and Python modules of an installation look for it.
const GdalFunctions* load() {
  const fs::path folder = own_file().parent_path();
  for (const char* place :
       {"../lib/csrbf", "csrbf", ".", "../../lib/csrbf", "../..", "../../..", CSRBF_PLUGIN_FOLDER}) {
    const fs::path file = folder / place / "csrbf-gdal.so";
    std::error_code error;
    if (!fs::exists(file, error)) continue;
    void* const part = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (part == nullptr) continue;
    using Entry = const GdalFunctions* (*)();
    if (const auto entry = reinterpret_cast<Entry>(dlsym(part, CSRBF_TEXT(CSRBF_GDAL_ENTRY)))) return entry();
  }
  return nullptr;
}

#endif

const GdalFunctions* functions() {
  static const GdalFunctions* const loaded = load();
  return loaded;
}

const GdalFunctions& required(const std::string& path) {
  if (const GdalFunctions* known = functions()) return *known;
  throw IoError(display_name(path) + ": " + file_extension(path) +
                " files need GDAL, which this build of csrbf is without; convert the file, as by gdal_translate or "
                "ogr2ogr, or build csrbf where libgdal-dev is installed");
}

void check(const std::string& path, const std::string& failure) {
  if (!failure.empty()) throw IoError(display_name(path) + ": " + failure);
}

// A folder beside the output: GDAL writes several files for some formats. All of them move to their place at the end.
class OutputFolder {
 public:
  explicit OutputFolder(const std::string& path) : target_(path) {
    const AtomicFile probe(path);  // fails where nothing can be written
    folder_ = target_;
    folder_ += ".writing";
    std::error_code error;
    fs::remove_all(folder_, error);
    if (!fs::create_directory(folder_, error))
      throw IoError(path + ": cannot make a folder beside it: " + error.message());
  }
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;
  ~OutputFolder() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }

  [[nodiscard]] std::string file() const { return (folder_ / target_.filename()).string(); }

  void move() const {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      std::error_code error;
      fs::rename(entry.path(), target_.parent_path() / entry.path().filename(), error);
      if (error) throw IoError(target_.string() + ": cannot write the file: " + error.message());
    }
  }

 private:
  fs::path target_, folder_;
};

}  // namespace

std::string gdal_version() {
  return functions() != nullptr ? functions()->version() : "";
}

std::optional<bool> gdal_is_geographic(const std::string& crs) {
  bool geographic = false;
  std::string name;
  if (crs.empty() || functions() == nullptr || !functions()->describe_crs(crs, geographic, name).empty())
    return std::nullopt;
  return geographic;
}

std::optional<int> epsg_code(std::string_view crs) {
  constexpr std::string_view authority = "epsg:";
  constexpr std::int64_t most = 65535;  // keys of GeoTIFF have 16 bits
  if (!lower_case(crs).starts_with(authority)) return std::nullopt;
  const auto code = parse_integer(crs.substr(authority.size()));
  if (!code || *code < 1 || *code > most) return std::nullopt;
  return static_cast<int>(*code);
}

std::string checked_crs(const std::string& given) {
  bool geographic = false;
  std::string name;
  if (given.empty()) return given;
  const std::string crs = parse_integer(given) ? "EPSG:" + given : given;
  if (functions() == nullptr) {
    if (const std::optional<int> code = epsg_code(crs)) return "EPSG:" + std::to_string(*code);
    throw IoError("the reference system " + in_quotes(crs) +
                  " is not known in this build, which is without GDAL; give its EPSG code, as EPSG:32633");
  }
  if (const std::string failure = functions()->describe_crs(crs, geographic, name); !failure.empty())
    throw IoError("the reference system " + in_quotes(crs) + " is not known: " + failure);
  return name;
}

GdalRaster read_gdal_raster(const std::string& path) {
  GdalRaster raster;
  if (path == "-") throw IoError("standard input: files of maps are read by name only");
  check(path, required(path).read_raster(path, raster));
  return raster;
}

void write_gdal_raster(const std::string& path, const GdalRaster& raster) {
  const GdalFunctions& gdal = required(path);
  const OutputFolder output(path);
  check(path, gdal.write_raster(output.file(), raster));
  output.move();
}

bool is_gdal_table(const std::string& extension) {
  return is_listed(extension, ".gpkg .shp .geojson .fgb");
}

Table read_gdal_table(const std::string& path, std::string& crs) {
  GdalTable points;
  check(path, required(path).read_table(path, points));
  crs = points.crs;
  Table table;
  table.names = points.names;
  const Index rows = points.columns.empty() ? 0 : std::ssize(points.columns.front());
  table.values.resize(std::ssize(points.columns), rows);
  for (Index c = 0; c < table.values.rows(); ++c)
    table.values.row(c) =
        Eigen::Map<const Eigen::RowVectorXd>(points.columns[static_cast<std::size_t>(c)].data(), rows);
  return table;
}

void write_gdal_table(const std::string& path, const std::vector<std::string>& names,
                      const Eigen::Ref<const Eigen::MatrixXd>& columns, const std::string& crs) {
  const GdalFunctions& gdal = required(path);
  GdalTable table;
  table.names = names;
  table.crs = crs;
  for (Index c = 0; c < columns.rows(); ++c) {
    const Eigen::VectorXd column = columns.row(c).transpose();
    table.columns.emplace_back(column.begin(), column.end());
  }
  const OutputFolder output(path);
  check(path, gdal.write_table(output.file(), table));
  output.move();
}

std::vector<Points<2>> read_gdal_lines(const std::string& path) {
  GdalLines found;
  check(path, required(path).read_lines(path, found));
  std::vector<Points<2>> lines;
  for (const std::vector<double>& vertices : found.vertices)
    lines.emplace_back(Eigen::Map<const Points<2>>(vertices.data(), 2, std::ssize(vertices) / 2));
  return lines;
}

void write_gdal_lines(const std::string& path, const std::vector<Points<2>>& lines, const std::string& field,
                      const Eigen::VectorXd& numbers, const std::string& crs) {
  const GdalFunctions& gdal = required(path);
  GdalLines given{{}, field, {numbers.begin(), numbers.end()}, crs};
  for (const Points<2>& line : lines) given.vertices.emplace_back(line.data(), line.data() + line.size());
  const OutputFolder output(path);
  check(path, gdal.write_lines(output.file(), given));
  output.move();
}

}  // namespace csrbf
