#include "commands/command_flags.hpp"
#include "commands/formats.hpp"

#include "csrbf/approx/fit_options.hpp"
#include "csrbf/kernels/kernel.hpp"

namespace csrbf::app {
namespace {

std::vector<std::string> with_auto(std::vector<std::string> names) {
  names.insert(names.begin(), "auto");
  return names;
}

void add_fit_flags(CommandFlags& v, FitFlags& f) {
  v.named_flag("method", f.method, fit_methods(), "auto",
               "auto, interpolate, least-squares, partition-of-unity, multilevel, pca-multiresolution, fixed-budget, "
               "error-bounded, moving-least-squares or along-tracks; auto chooses from the data");
  v.named_flag("kernel", f.kernel, with_auto(Kernel::names(1)), "auto",
               "radial basis function: wendland-c2, gaussian, cubic, thin-plate, ... (an unknown name lists them all; "
               "names of SciPy are understood)");
  v.flag("kernel-parameter", f.kernel_parameter, "P", "of the kernel",
         "parameter of kernels that have one, such as matern");
  v.positive_flag("centers", f.centers, "N", "from the data", "budget of RBF centres");
  v.positive_flag("tolerance", f.tolerance, "E", "none",
                  "largest error allowed at any sample, in the unit of the values");
  v.flag("smoothing", f.smoothing, "auto|none|L", "auto", "how much noise to smooth away; larger is smoother");
  v.flag("degree", f.degree, "N", "from the data", "degree of the polynomial part")->check(CLI::Range(0, 8));
  v.flag("loss", f.loss, "auto|squares|huber|student", "auto",
         "how samples far from their neighbours count: auto leaves gross errors out and names them, squares keeps all, "
         "huber and student give them less weight")
      ->check(CLI::IsMember({"auto", "squares", "huber", "student"}));
  v.flag("transform", f.transform, "auto|none|sqrt|log", "auto",
         "fit the values, their square roots or their logarithms, and transform the result back; auto: roots or "
         "logarithms for amounts that vary more where they are larger")
      ->check(CLI::IsMember(fit_transforms()));
  v.flag("extrapolation", f.extrapolation, "auto|constant|linear|trend|nan", "auto",
         "outside the box of the samples: constant keeps the value at the nearest point of the box, linear its slope, "
         "too, trend returns to the trend of the samples; auto: with few samples trend or constant, whichever predicts "
         "the outermost better, with many linear for a little way, then constant")
      ->check(CLI::IsMember({"auto", "constant", "linear", "trend", "nan"}));
}

}  // namespace

void declare(CommandFlags& v, FitCommand& c) {
  v.argument(
      "SAMPLES", c.input,
      std::string("samples to read, one per row: coordinates, then the value in the last column; ") + sample_formats);
  v.output(c.output, "model to write: .csrbf");
  add_fit_flags(v, c.fit);
  v.flag("coordinates", c.coordinates, "COLUMNS", "all others",
         "names or numbers (from 1) of the columns of coordinates, separated by commas");
  v.flag("values", c.values, "COLUMNS", "the last one", "names or numbers of the columns of values");
  v.flag("weights", c.weights, "COLUMN", "none", "column of weights: the inverse variances of the values");
  v.flag("periods", c.periods, "P,P,...", "none",
         "period of each coordinate, 0 for none: 360,0 for longitude and latitude");
  v.flag("sphere", c.sphere, "LON,LAT", "none",
         "columns of longitude and latitude, in degrees: distances are those on the sphere");
  v.flag("derivatives", c.derivatives, "COLUMN,...", "none",
         "columns of derivatives of the values by each coordinate: gradients as data; empty cells are unknown");
  v.flag("faults", c.faults, "FILE", "none",
         "polylines in the plane across which the function may jump: a table with columns x, y and, for several, the "
         "number of the line, or the lines of a map (.gpkg .shp .geojson .fgb)");
  v.flag("drift", c.drift, "COLUMN,...", "none",
         "columns of covariates, which enter linearly (universal kriging); evaluate needs them as well");
  v.flag("missing", c.missing, "VALUE", "none",
         "value, such as -9999, that marks missing ones: such samples are left out");
  v.toggle("--standard-deviation", c.standard_deviation,
           "provide standard deviations with every method, from a second fit if the method has none (auto, "
           "partition-of-unity, along-tracks and interpolate, if not of more than 4000 samples with a compact kernel, "
           "have them in any case)");
  add_point_flags(v, c.points);
  add_tile_flags(v, c.tiles);
}

void declare(CommandFlags& v, EvaluateCommand& c) {
  v.argument(
      "MODEL", c.input,
      "model to read: .csrbf, from csrbf fit or csrbf segment, or a surface, which is a function that is positive "
      "inside");
  v.output(c.output, std::string("values to write: .csv .txt .npy, or - for text on standard output; points on maps as "
                                 ".gpkg .shp .geojson .fgb; grids also as images: ") +
                         image_formats + "; .tif and .asc are maps with the north on top");
  v.flag("points", c.points, "FILE", "", std::string("points to evaluate at, one per row: ") + sample_formats);
  v.flag("grid", c.grid, "[NX[,NY[,NZ]]]", "",
         "evaluate at the nodes of a grid: their number along each axis, or one number for all axes; without numbers "
         "as many as --cell makes, or 500 along each axis in the plane and 100 in space")
      ->expected(0, 1);
  v.flag("bounds", c.bounds, "LO:HI,...", "box of the samples", "first and last node of the grid along each axis");
  v.flag("cell", c.cell, "SIZE[,SIZE]", "from --grid",
         "size of the cells of the grid, whose centres are the nodes, in the unit of the coordinates");
  v.flag("extent", c.extent, "LO,HI", "box of the samples, in whole cells",
         "the corners of the map, as XMIN,YMIN,XMAX,YMAX: outer edges of the cells");
  v.flag(
      "crs", c.crs, "NAME", "of the samples",
      "reference system of the coordinates on a map, such as EPSG:32633, to write into .tif, .asc, .nc, .gpkg and the "
      "like; nothing is transformed");
  v.flag("like", c.like, "FILE", "",
         "evaluate at the voxels of this image, in its physical coordinates; the result has its grid");
  v.toggle("--gradient", c.gradient, "write the gradient after the values");
  v.toggle("--hessian", c.hessian, "write the upper triangle of the Hessian after them");
  v.toggle("--standard-deviation", c.standard_deviation,
           "write, as the last columns, the standard deviation of a sample there from the value (models of other "
           "methods than auto, interpolate and partition-of-unity: if fit had the flag, too)");
  v.flag("deviation-of", c.deviation_of, "sample|function", "sample",
         "whether it contains the noise of a sample, or is that of the function alone")
      ->check(CLI::IsMember({"sample", "function"}));
  v.toggle(
      "--labels", c.labels,
      "write labels instead of values, like csrbf segment: with one component, 1 where it is positive and 0 elsewhere; "
      "with several, the number of the largest, from 0");
  v.flag("mask", c.mask, "hull|distance:D", "none",
         "no values (NaN) outside the convex hull of the samples, or farther than D from all of them (on a sphere in "
         "degrees)");
  v.flag("extrapolation", c.extrapolation, "constant|linear|trend|nan", "as in the fit",
         "outside the box of the samples, see csrbf fit")
      ->check(CLI::IsMember({"constant", "linear", "trend", "nan"}));
  v.flag("levels", c.levels, "[every:STEP|LEVEL,...]", "",
         "write contour lines instead of values, of functions of two variables: .csv .ply .vtp, or on maps .gpkg .shp "
         ".geojson .fgb; without a value at about ten round levels")
      ->expected(0, 1);
  v.toggle("--float32", c.float32, "keep and write the values of a grid or image in single precision: half the memory");
}

void declare(CommandFlags& v, InpaintCommand& c) {
  v.argument("IMAGE", c.input, std::string("image to read: ") + image_formats + ", or DICOM (a file or folder)");
  v.output(c.output, std::string("image to write: ") + image_formats);
  v.flag("mask", c.mask, "FILE", "", "image of the same size, nonzero where values are missing or unreliable");
  v.flag("missing", c.missing, "VALUE", "nan", "value that marks missing pixels; NaN always does");
  v.flag(
      "blocks", c.blocks, "auto|none|N", "auto",
      "width in pixels of blocks that continue edges and textures into what is missing; none: the fitted function as "
      "it is; auto: what is best at known pixels, none where flags of the fit are given");
  v.flag("memory", c.memory, "SIZE", "all at once",
         "work by blocks of slices that need about so much memory, for instance 2GB; .nii, .nii.gz and .npy");
  add_fit_flags(v, c.fit);
}

}  // namespace csrbf::app
