#include "commands/command_flags.hpp"
#include "commands/formats.hpp"

namespace csrbf::app {
namespace {

void declare_segmentation(CommandFlags& v, SegmentFlags& c) {
  v.flag("energy", c.energy, "NAME", c.energy,
         "what distinguishes regions: auto (chan-vese or gaussian and the shading, by the shortest description); "
         "chan-vese (means), gaussian (means and variances), generalized-gaussian (textures "
         "too), rayleigh, gamma (ultrasound), edge (a short contour on edges; needs --init)")
      ->check(CLI::IsMember({"auto", "chan-vese", "gaussian", "generalized-gaussian", "rayleigh", "gamma", "edge"}));
  v.flag("init", c.init, "WHERE", c.init,
         "initial inside, in physical units of the image: auto; sphere:X,Y[,Z],R; box:X,Y[,Z],X,Y[,Z] (two corners); "
         "mask:FILE (nonzero inside); points:FILE (some points on the boundary); or MODEL.csrbf");
  v.flag("regions", c.regions, "N", "2", "number of regions, labels 0 to N-1 by ascending intensity")
      ->check(CLI::Range(2, 16));
  v.flag("center-spacing", c.center_spacing, "S", "1 to 12, from objects and noise",
         "spacing of the RBF centres in voxels, at most half the image: smaller resolves more detail")
      ->check(CLI::Range(1.0, 1e6));
  v.flag("support", c.support, "RHO", "2.5, collocation 4", "their support radius, in center spacings")
      ->check(CLI::Range(1.1, 16.0));
  v.named_flag("kernel", c.kernel, {"wendland-c2", "wendland-c4", "wendland-c6"}, c.kernel,
               "compactly supported radial basis function; wendland-c4 for smooth curvatures");
  v.flag(
      "smoothness", c.smoothness, "auto|L", "auto",
      "weight of the contour length relative to the contrast, in voxels: details of a smaller radius vanish; auto: 0, "
      "as the centres smooth already (edge: 1); a number takes --energy auto for chan-vese");
  v.flag("window", c.window, "N", "0, generalized-gaussian from 1 on",
         "energies are averaged over boxes of 2 N + 1 voxels: larger separates textures, smaller keeps details")
      ->check(CLI::Range(0, 1000));
  v.flag("shading", c.shading, "auto|none|linear|quadratic|smooth|objects|background", "auto",
         "how the means vary over the image, for auto, chan-vese and gaussian in global mode; smooth, objects (a mean "
         "for each component) and background (added to all of it) with --energy auto only")
      ->check(CLI::IsMember({"auto", "none", "linear", "quadratic", "smooth", "objects", "background"}));
  v.flag("balloon", c.balloon, "P", "0", "pressure of the energy edge, from -1 (shrink) to 1 (grow)")
      ->check(CLI::Range(-1.0, 1.0));
  v.flag("fill-holes", c.fill_holes, "auto|yes|no", "auto",
         "count everything the contour encloses as inside; auto: in local mode only")
      ->check(CLI::IsMember({"auto", "yes", "no"}));
  v.flag("mask", c.mask, "FILE|box:...", "",
         "image of the same size, 0 in voxels to ignore; or box:X,Y[,Z],X,Y[,Z], the two corners of what to look at");
  v.flag("mode", c.mode, "global|local", c.mode,
         "global: regions appear wherever they fit; local: the contour evolves from its start")
      ->check(CLI::IsMember({"global", "local"}));
  v.flag("method", c.method, "NAME", c.method,
         "variational; collocation: the earlier scheme, thresholding between the centres; finite-difference: upwind "
         "scheme "
         "on the voxels")
      ->check(CLI::IsMember({"variational", "collocation", "finite-difference"}));
  v.flag("iterations", c.iterations, "N", "100", "largest number of iterations")->check(CLI::Range(1, 1000000));
}

}  // namespace

void declare(CommandFlags& v, SegmentCommand& c) {
  v.argument("IMAGE", c.input, std::string("2D or 3D image to read: ") + label_formats);
  v.output(c.output, "labels to write, 0 outside: the same formats");
  declare_segmentation(v, c);
  v.flag("contour", c.contour, "FILE", "",
         std::string("write the contour, finer than voxels: ") + plane_contour_formats + " in the plane, " +
             written_mesh_formats + " in space");
  v.flag("model", c.model, "FILE", "",
         "save the level set: .csrbf, for csrbf evaluate, polygonize, render and curvature");
  v.flag("preview", c.preview, "FILE", "",
         "draw the contour on the image, or on the slice with the largest area inside: .png");
  v.flag("seeds", c.seeds, "FILE", "",
         "voxels that are known, some of every region (in local mode the background may be left out): an image, or a "
         "table of points, of numbers that are 1 for label "
         "0, 2 for label 1 and so on; 0: not known");
  v.flag(
      "seed-confidence", c.seed_confidence, "P|FILE", "1",
      "probability that a seed is right: below 1, clear intensities overrule it; an image has that of each voxel, and "
      "a table of seeds may have it in a column after the label");
  v.flag(
      "missing", c.missing, "auto|VALUE", c.missing,
      "value, such as -9999, of voxels that are missing: they are ignored and get label 0, as NaN always does; auto: a "
      "block of one extreme value at the border, or a negative one, far from all others, or a frame with straight or "
      "round edges; nan: no other value");
  v.flag("channels", c.channels, "LIST", "all but transparency",
         "components of the image to use, from 1 on: 1,3 are the red and the blue of a colour image");
  v.toggle("--objects", c.objects,
           "split what is inside into objects, touching ones too, and write their numbers, 1 to n, as labels");
  v.flag("table", c.table, "FILE", "", "size, place, shape and mean of every object: .csv");
  v.flag("min-size", c.min_size, "N", "a tenth of the median of the objects, and no holes",
         "leave out objects, and fill holes, of fewer voxels")
      ->check(CLI::Range(1, 2147483647));
}

void declare(CommandFlags& v, TrackCommand& c) {
  v.argument("IMAGES", c.inputs, std::string("frames in order, or one image with frames: ") + label_formats);
  v.output(c.output, "folder for labels_0000.EXT, ..., measures.csv and models");
  declare_segmentation(v, c);
  v.flag("persistence", c.persistence, "P", "1",
         "how strongly contours of noisy frames are pulled towards those of their neighbours; 0: not at all")
      ->check(CLI::Range(0.0, 100.0));
  v.positive_flag("motion", c.motion, "VOXELS", "half the depth of the inside",
                  "largest distance the contour may move from one frame to the next");
  v.flag("prediction", c.prediction, "P", "1 with one sweep, else 0",
         "where the first sweep expects the contour: from 0, where it was, to 1, extrapolated by its last motion")
      ->check(CLI::Range(0.0, 1.0));
  v.flag("sweeps", c.sweeps, "N", "2", "1: forward only; more: back and forth, so that the contour does not lag behind")
      ->check(CLI::Range(1, 100));
  v.flag("format", c.format, "EXT", "that of the images", "extension of the label images, such as nii.gz");
  v.flag("contour", c.contour, "EXT", "",
         std::string("also write contours_0000.EXT, ..., finer than voxels: ") + plane_contour_formats +
             " in the plane, " + written_mesh_formats + " in space");
  v.toggle("--slices-are-frames", c.slices_are_frames, "the third axis is time: pages of .tif, .npy arrays [t, y, x]");
}

}  // namespace csrbf::app
