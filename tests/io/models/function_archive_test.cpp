#include "csrbf/io/models/function_archive.hpp"
#include "csrbf/io/model.hpp"

#include "csrbf/approx/basis/expansion.hpp"
#include "csrbf/approx/fit.hpp"
#include "csrbf/approx/moving/moving_least_squares.hpp"
#include "csrbf/approx/unity/partition_of_unity.hpp"

#include "io/io_testing.hpp"

#include <functional>
#include <random>

namespace csrbf::function_archive_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

template <int Dim>
Samples<Dim> wavy_samples(Index n, Index components = 1) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> uniform(0, 1);
  Samples<Dim> samples{
      Points<Dim>::NullaryExpr(Dim, n, [&] { return uniform(random); }), Eigen::MatrixXd(n, components), {}};
  for (Index c = 0; c < components; ++c)
    samples.values.col(c) = (3 * samples.points.colwise().sum().array() + static_cast<double>(c)).sin();
  return samples;
}

// Inside and around the unit cube, some of them NaN.
template <int Dim>
Eigen::MatrixXd probes() {
  std::mt19937_64 random(8);
  std::uniform_real_distribution<double> uniform(-.3, 1.3);
  Eigen::MatrixXd x = Eigen::MatrixXd::NullaryExpr(Dim, 300, [&] { return uniform(random); });
  x(0, 17) = std::nan("");
  return x;
}

bool same(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         (a.array() == b.array() || (a.array().isNaN() && b.array().isNaN())).all();
}

void expect_same_function(const Function& read, const Function& written, const Eigen::MatrixXd& x) {
  const Function::Values found = read.evaluate(x, Derivatives::hessian);
  const Function::Values expected = written.evaluate(x, Derivatives::hessian);
  EXPECT_TRUE(same(found.value, expected.value));
  EXPECT_TRUE(same(found.gradient, expected.gradient));
  EXPECT_TRUE(same(found.hessian, expected.hessian));
  EXPECT_EQ(read.bounds(), written.bounds());
}

Function round_trip(const Function& function) {
  return function_from(parse_archive(format_archive(to_archive({function})), "model")).function;
}

TEST(FunctionArchive, KeepsEveryMethodBitForBit) {
  for (const std::string& method : fit_methods()) {
    SCOPED_TRACE(method);
    FitOptions options{.method = method};
    if (method == "error-bounded" || method == "pca-multiresolution") options.tolerance = .02;
    if (method == "fixed-budget") options.centers = 40;
    const Function function(fit(wavy_samples<2>(120, 2), options));
    expect_same_function(round_trip(function), function, probes<2>());
    if (method != "auto" && method != "interpolate" && method != "partition-of-unity") continue;
    const Eigen::MatrixXd deviation = function.standard_deviation(probes<2>());
    EXPECT_GT(deviation.array().isFinite().count(), 0);
    EXPECT_TRUE(same(round_trip(function).standard_deviation(probes<2>()), deviation));
  }
}

template <int Dim>
void expect_round_trip() {
  SCOPED_TRACE(Dim);
  const Function function(fit(wavy_samples<Dim>(150), {.method = "partition-of-unity"}));
  EXPECT_EQ(round_trip(function).dimension(), Dim);
  expect_same_function(round_trip(function), function, probes<Dim>());
}

TEST(FunctionArchive, KeepsFunctionsOfEveryDimension) {
  expect_round_trip<1>();
  expect_round_trip<2>();
  expect_round_trip<3>();
  expect_round_trip<4>();
  expect_round_trip<5>();
  expect_round_trip<6>();
}

TEST(FunctionArchive, KeepsTheMetricsOfPatches) {
  const auto partition = partition_of_unity<2>(
      wavy_samples<2>(300), {.kernel = "powered-exponential", .samples_per_patch = 12, .anisotropy = .8});
  Fit<2> model{partition.fields(), {}, {}};
  model.report.partition = {partition.report.patches, 12, partition.report.local.anisotropy};
  const Function function(model);
  expect_same_function(round_trip(function), function, probes<2>());
  EXPECT_EQ(round_trip(function).report().partition->anisotropy, .8);
}

Function function_with_a_gap() {
  const Samples<2> all = wavy_samples<2>(1500, 2);
  std::vector<Index> kept;
  for (Index i = 0; i < all.size(); ++i)
    if (all.points.col(i).sum() < 1) kept.push_back(i);
  return Function(fit(Samples<2>{all.points(Eigen::all, kept), all.values(kept, Eigen::all), {}},
                      {.method = "partition-of-unity"}));
}

TEST(FunctionArchive, KeepsWhatIsInGaps) {
  const Function function = function_with_a_gap();
  const Archive archive = parse_archive(format_archive(to_archive({function})), "model");
  const auto is_wide = [](const auto& entry) { return entry.first.ends_with("wide_of"); };
  EXPECT_TRUE(std::any_of(archive.values().begin(), archive.values().end(), is_wide));
  expect_same_function(round_trip(function), function, probes<2>());
  EXPECT_TRUE(same(round_trip(function).standard_deviation(probes<2>()), function.standard_deviation(probes<2>())));
}

TEST(FunctionArchive, RefusesDamagedNumbersOfWhatIsInGaps) {
  const Archive good = parse_archive(format_archive(to_archive({function_with_a_gap()})), "model");
  std::string name;
  for (const auto& [entry, value] : good.values())
    if (entry.ends_with("wide_of")) name = entry;
  for (const std::int32_t number : {-2, 1 << 20, std::numeric_limits<std::int32_t>::max()}) {
    Archive bad = good;
    ArchiveArray<std::int32_t> wide_of = good.array<std::int32_t>(name);
    wide_of(0, 0) = number;
    bad.set(name, wide_of);
    EXPECT_NE(io_error([&] { (void)function_from(bad); }), "no exception") << number;
  }
}

TEST(FunctionArchive, KeepsScaledPeriodicAndUndefinedAxes) {
  Samples<2> samples = wavy_samples<2>(400);
  samples.points.row(1) *= 1000;
  const Function scaled(fit(samples, {.method = "partition-of-unity", .extrapolation = Extrapolation::nan}));
  ASSERT_NE(scaled.report().axis_scales[0], scaled.report().axis_scales[1]);
  Eigen::MatrixXd x = probes<2>();
  x.row(1) *= 1000;
  expect_same_function(round_trip(scaled), scaled, x);
  ASSERT_TRUE(scaled.evaluate(x).value.array().isNaN().any());

  const Function periodic(fit(wavy_samples<2>(400), {.method = "partition-of-unity", .periods = {1, 0}}));
  expect_same_function(round_trip(periodic), periodic, probes<2>());
}

TEST(FunctionArchive, KeepsMetricsSupportsAndTailsOfExpansions) {
  Points<2> centers(2, 3);
  centers << .1, .5, .9, .2, .8, .3;
  RadialMetric<2> metric;
  Eigen::Matrix2d stretch;
  stretch << 2, .5, 0, 1;
  metric.transforms = {stretch, Eigen::Matrix2d::Identity(), 3 * stretch};
  metric.periods = Point<2>(2, 0);
  PolynomialTail<2> tail{1, Point<2>(.5, .4), .7, Eigen::Vector3d(1, 2, 3)};
  Fit<2> fit;
  fit.components = {make_expansion<2>(Kernel("wendland-c4", 2), centers, Eigen::Vector3d(.5, .6, .7),
                                      Eigen::Vector3d(1, -2, 3), tail, metric),
                    make_expansion<2>(Kernel("matern", 2, 2.25), centers, Eigen::VectorXd::Constant(1, .4),
                                      Eigen::Vector3d(3, 2, 1))};
  const Function function(fit);
  expect_same_function(round_trip(function), function, probes<2>());
}

TEST(FunctionArchive, StoresWhatComponentsShareOnce) {
  const FitOptions options{.method = "moving-least-squares"};
  const auto size = [&](Index components) {
    return format_archive(to_archive({Function(fit(wavy_samples<2>(2000, components), options))})).size();
  };
  // Eight bytes per sample and component besides the points and radii.
  EXPECT_LT(size(5), size(1) + 4 * 2000 * 8 + 8192);
}

TEST(FunctionArchive, KeepsTheReportAndTheNames) {
  Function function(fit(wavy_samples<2>(200, 2), {.method = "partition-of-unity"}));
  const TemporaryFolder folder;
  write_model(folder.file("f.csrbf"), {function, {"longitude", "latitude"}, {"u", "v"}});
  const NamedFunction read = read_function(folder.file("f.csrbf"));
  EXPECT_EQ(read.coordinate_names, (std::vector<std::string>{"longitude", "latitude"}));
  EXPECT_EQ(read.value_names, (std::vector<std::string>{"u", "v"}));
  const FitReport &found = read.function.report(), &expected = function.report();
  EXPECT_EQ(found.method, expected.method);
  EXPECT_EQ(found.kernel, expected.kernel);
  EXPECT_EQ(found.samples, expected.samples);
  EXPECT_EQ(found.centers, expected.centers);
  EXPECT_EQ(found.partition.value_or(PartitionReport{}).patches,
            expected.partition.value_or(PartitionReport{}).patches);
  EXPECT_EQ(found.degree, expected.degree);
  EXPECT_EQ(found.smoothing, expected.smoothing);
  EXPECT_EQ(found.rmse, expected.rmse);
  EXPECT_EQ(found.max_error, expected.max_error);
  EXPECT_EQ(found.cross_validation_rmse, expected.cross_validation_rmse);
  EXPECT_EQ(found.axis_scales, expected.axis_scales);
  EXPECT_EQ(found.warnings, expected.warnings);

  write_model(folder.file("default.csrbf"), {function});
  EXPECT_EQ(read_function(folder.file("default.csrbf")).coordinate_names, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(read_function(folder.file("default.csrbf")).value_names, (std::vector<std::string>{"value1", "value2"}));
  write_model(folder.file("again.csrbf"), read);
  EXPECT_EQ(content(folder.file("again.csrbf")), content(folder.file("f.csrbf")));
}

TEST(FunctionArchive, OfThreeVariablesCountsAsASurface) {
  const TemporaryFolder folder;
  const Fit<3> solid = fit(wavy_samples<3>(300), {.method = "multilevel"});
  write_model(folder.file("solid.csrbf"), {Function(solid)});
  const auto field = read_model(folder.file("solid.csrbf"));
  const Points<3> x = probes<3>();
  EXPECT_TRUE(same(field->evaluate(x).value, solid.components[0]->evaluate(x).value));

  write_model(folder.file("plane.csrbf"), {Function(fit(wavy_samples<2>(60)))});
  EXPECT_NE(io_error([&] {
              (void)read_model(folder.file("plane.csrbf"));
            }).find("plane.csrbf: this is a function of 2 variables with 1 components, not a surface"),
            std::string::npos);
}

TEST(FunctionArchive, RefusesFieldsWithoutFileFormAndNamesThatDoNotFit) {
  class Nothing : public Field<2> {
   public:
    void evaluate_block(const PointsRef<2>&, const JetBlock&) const override {}
    [[nodiscard]] Box<2> bounds() const override { return {}; }
  };
  const auto message = [](const NamedFunction& function) {
    try {
      (void)to_archive(function);
    } catch (const InvalidInput& error) {
      return std::string(error.what());
    }
    return std::string("nothing thrown");
  };
  Fit<2> nothing;
  nothing.components = {std::make_shared<Nothing>()};
  EXPECT_EQ(message({Function(nothing)}), "write_model: field: this kind of field has no file form");
  const Function function(fit(wavy_samples<2>(50)));
  EXPECT_NE(message({function, {"x"}}).find("coordinate_names = 1"), std::string::npos);
  EXPECT_NE(message({function, {}, {"a", "b"}}).find("value_names = 2"), std::string::npos);
}

// Every number and array of the file, replaced behind the checksum: read or refused, and never more than that.
class DamagedFunction : public ::testing::TestWithParam<std::string> {
 protected:
  DamagedFunction() {
    FitOptions options{.method = GetParam()};
    if (GetParam() == "interpolate") options.kernel = "thin-plate";
    if (GetParam() == "error-bounded") options.tolerance = .05;
    archive_ = to_archive({Function(fit(wavy_samples<2>(80), options))});
    archive_.source = "bad.csrbf";
  }

  // What function_from says after the entry was replaced; the function that it reads can be evaluated.
  std::string error_after(const std::string& name, const Archive::Value& value) {
    Archive changed = archive_;
    changed.insert(name, value);
    return io_error([&] { (void)function_from(changed).function.evaluate(probes<2>()); });
  }

  static bool is_refusal(const std::string& error) { return error.starts_with("bad.csrbf: "); }

  Archive archive_;
};

TEST_P(DamagedFunction, WithoutAnEntryIsRefused) {
  for (const auto& [gone, value] : archive_.values()) {
    Archive rest;
    rest.kind = archive_.kind;
    rest.source = archive_.source;
    for (const auto& [name, kept] : archive_.values())
      if (name != gone) rest.insert(name, kept);
    const bool is_new = gone == "component0/growth" || gone == "variance0/growth" || gone == "variance_unit" ||
                        gone == "component0/rim" || gone == "variance0/rim" || gone == "report/gross_errors" ||
                        gone == "report/drift" || gone == "places";  // models written before there were any
    if (is_new) {
      EXPECT_NO_THROW((void)function_from(rest)) << gone;
    } else if (gone == "report/anisotropy") {  // likewise
      EXPECT_EQ(function_from(rest).function.report().partition.value_or(PartitionReport{}).anisotropy, 0);
    } else {
      EXPECT_TRUE(is_refusal(io_error([&] { (void)function_from(rest); }))) << gone;
    }
  }
}

TEST_P(DamagedFunction, WithEntriesOfAnotherTypeIsRefused) {
  for (const auto& [name, value] : archive_.values()) {
    const bool is_text = std::holds_alternative<std::string>(value);
    EXPECT_TRUE(is_refusal(error_after(name, is_text ? Archive::Value(1.5) : Archive::Value(std::string("?")))))
        << name;
  }
}

TEST_P(DamagedFunction, WithWildWholeNumbersIsRefusedOrRead) {
  for (const auto& [name, value] : archive_.values()) {
    if (!std::holds_alternative<std::int64_t>(value)) continue;
    for (const std::int64_t wild : {std::numeric_limits<std::int64_t>::min(), std::int64_t{-2}, std::int64_t{0},
                                    std::int64_t{3}, std::int64_t{19}, std::int64_t{1} << 40}) {
      const std::string error = error_after(name, wild);
      EXPECT_TRUE(is_refusal(error) || error == "no exception") << name << " = " << wild << ": " << error;
    }
  }
}

TEST_P(DamagedFunction, WithWildNumbersIsRefusedOrRead) {
  for (const auto& [name, value] : archive_.values()) {
    if (const auto* number = std::get_if<double>(&value)) {
      for (const double wild : {std::nan(""), -1.0, 0.0, 1e300, *number + 1}) {
        const std::string error = error_after(name, wild);
        EXPECT_TRUE(is_refusal(error) || error == "no exception") << name << " = " << wild << ": " << error;
      }
    }
    if (const auto* array = std::get_if<ArchiveArray<double>>(&value); array != nullptr && array->size() > 0) {
      for (const double wild : {std::nan(""), -1.0, 0.0, 1e300}) {
        ArchiveArray<double> changed = *array;
        changed(0, 0) = wild;
        const std::string error = error_after(name, changed);
        EXPECT_TRUE(is_refusal(error) || error == "no exception") << name << " = " << wild << ": " << error;
      }
      // Information of the report, or supports: one for all centres will do as well.
      const bool is_free = name.ends_with("_scales") || name.ends_with("/supports") || name.starts_with("report/");
      if (!is_free) {
        EXPECT_TRUE(is_refusal(error_after(name, ArchiveArray<double>(array->topRows(array->rows() - 1))))) << name;
      }
    }
  }
}

TEST_P(DamagedFunction, WithADamagedTreeIsRefused) {
  for (const auto& [name, value] : archive_.values()) {
    if (!name.ends_with("/tree")) continue;
    const auto& tree = std::get<ArchiveArray<std::int64_t>>(value);
    for (Index row = 0; row < tree.rows(); ++row)
      for (Index node = 0; node < tree.cols(); ++node)
        for (const std::int64_t step : {-1, 1, 5}) {
          ArchiveArray<std::int64_t> changed = tree;
          changed(row, node) += step;
          const std::string error = error_after(name, changed);
          // Another axis may do by chance.
          EXPECT_TRUE(is_refusal(error) || (row == 0 && error == "no exception")) << node << ": " << error;
        }
  }
}

INSTANTIATE_TEST_SUITE_P(Method, DamagedFunction,
                         ::testing::Values("interpolate", "partition-of-unity", "multilevel", "error-bounded",
                                           "moving-least-squares", "along-tracks"),
                         [](const auto& method) {
                           std::string name = method.param;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST(FunctionArchive, OfAnotherKindIsRefused) {
  const TemporaryFolder folder;
  Archive other;
  other.kind = "recipe";
  write_archive(folder.file("recipe.csrbf"), other);
  const std::string message = io_error([&] { (void)read_function(folder.file("recipe.csrbf")); });
  EXPECT_EQ(message.find(folder.file("recipe.csrbf") + ": "), 0U) << message;
  EXPECT_NE(message.find("\"recipe\""), std::string::npos) << message;
}

TEST(FunctionArchive, RefusesTruncatedFlippedAndFutureFiles) {
  const TemporaryFolder folder;
  const std::string bytes = format_archive(to_archive({Function(fit(wavy_samples<2>(100)))}));
  for (std::size_t k = 0; k < 40; ++k) {
    const std::size_t at = k * bytes.size() / 40;
    const std::string cut = folder.with("cut.csrbf", bytes.substr(0, at));
    EXPECT_NE(io_error([&] { (void)read_function(cut); }).find("cut.csrbf"), std::string::npos) << at;
    std::string flipped = bytes;
    flipped[at] = static_cast<char>(flipped[at] ^ 0x10);
    const std::string bad = folder.with("flipped.csrbf", flipped);
    EXPECT_NE(io_error([&] { (void)read_function(bad); }).find("flipped.csrbf"), std::string::npos) << at;
  }
  std::string future = bytes;
  future[8] = 99;  // the format, behind the magic
  EXPECT_NE(
      io_error([&] { (void)read_function(folder.with("future.csrbf", future)); }).find("written by a newer csrbf"),
      std::string::npos);
}

TEST(FunctionArchive, RefusesFieldsOfALaterVersion) {
  const TemporaryFolder folder;
  Archive archive = to_archive({Function(fit(wavy_samples<2>(100)))});
  for (const char* entry : {"component0/kind", "component0/inner/kind"}) {
    Archive later = archive;
    later.set(entry, std::string("wavelet"));
    write_archive(folder.file("later.csrbf"), later);
    EXPECT_NE(io_error([&] {
                (void)read_function(folder.file("later.csrbf"));
              }).find("this version knows no field of the kind \"wavelet\""),
              std::string::npos)
        << entry;
  }
}

}  // namespace
}  // namespace csrbf::function_archive_test
