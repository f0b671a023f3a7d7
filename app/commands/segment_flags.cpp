#include "commands/command_flags.hpp"
#include "commands/formats.hpp"

#include <string>

namespace csrbf::app {
namespace {

void declare_segmentation(CommandFlags& v, SegmentFlags& c) {
  v.flag("energy", c.energy, "NAME", c.energy,
         "what tells regions apart: chan-vese (means), gaussian (means and variances), generalized-gaussian (textures "
         "too), rayleigh, gamma (ultrasound), edge (a short contour on edges; needs --init)")
      ->check(CLI::IsMember({"chan-vese", "gaussian", "generalized-gaussian", "rayleigh", "gamma", "edge"}));
  v.flag(
      "init", c.init, "WHERE", c.init,
      "where to start, in the physical unit of the image: auto; sphere:X,Y[,Z],R; box:X,Y[,Z],X,Y[,Z] (two "
      "corners); mask:FILE (not 0 inside); points:FILE (some points on the boundary); or MODEL.csrbf. What it covers "
      "is inside");
  v.flag("regions", c.regions, "N", "2", "number of regions, labels 0 to N-1 by ascending intensity")
      ->check(CLI::Range(2, 16));
  v.flag("center-spacing", c.center_spacing, "S", "2 to 12, from the noise",
         "distance of the centres of the radial functions, in voxels, up to half the image: smaller shows more detail")
      ->check(CLI::Range(1.0, 1e6));
  v.flag("support", c.support, "RHO", "2.5, collocation 4", "their support radius, in center spacings")
      ->check(CLI::Range(1.1, 16.0));
  v.flag("kernel", c.kernel, "NAME", c.kernel, "compact radial function; wendland-c4 for smooth curvatures");
  v.flag("smoothness", c.smoothness, "auto|L", "auto",
         "weight of the length of the contour relative to the contrast, in voxels: details of a smaller radius vanish; "
         "auto: none, as the centres smooth already (edge: 1)");
  v.flag("window", c.window, "N", "0, generalized-gaussian from 1 on",
         "energies are averaged over boxes of 2 N + 1 voxels: more tells textures apart, less keeps details")
      ->check(CLI::Range(0, 1000));
  v.flag("shading", c.shading, "auto|none|linear|quadratic", "auto",
         "how the means vary over the image, for chan-vese and gaussian in global mode")
      ->check(CLI::IsMember({"auto", "none", "linear", "quadratic"}));
  v.flag("balloon", c.balloon, "P", "0", "pressure of the energy edge, from -1 (shrink) to 1 (grow)")
      ->check(CLI::Range(-1.0, 1.0));
  v.flag("fill-holes", c.fill_holes, "auto|yes|no", "auto",
         "count what the contour encloses as inside; auto: in local mode")
      ->check(CLI::IsMember({"auto", "yes", "no"}));
  v.flag("mask", c.mask, "FILE", "", "image of the same size that is 0 in voxels that take no part");
  v.flag("mode", c.mode, "global|local", c.mode,
         "global: regions appear wherever they fit; local: the contour moves from where it starts")
      ->check(CLI::IsMember({"global", "local"}));
  v.flag(
       "method", c.method, "NAME", c.method,
       "variational; collocation: the earlier scheme, thresholding between the centres; finite-difference: upwind, on "
       "the voxels")
      ->check(CLI::IsMember({"variational", "collocation", "finite-difference"}));
  v.flag("iterations", c.iterations, "N", "100", "at most so many")->check(CLI::Range(1, 1000000));
}

}  // namespace

void declare(CommandFlags v, SegmentCommand& c) {
  v.argument("IMAGE", c.input, std::string("image of two or three axes to read: ") + label_formats);
  v.output(c.output, "labels to write, 0 outside: the same formats");
  declare_segmentation(v, c);
  v.flag("contour", c.contour, "FILE", "",
         std::string("write the contour, finer than voxels: ") + plane_contour_formats + " in the plane, " +
             mesh_formats + " in space");
  v.flag("model", c.model, "FILE", "",
         "save the level set: .csrbf, for csrbf evaluate, polygonize, render and curvature");
  v.flag("preview", c.preview, "FILE", "", "draw the contour on the image, or on the slice with most of it: .png");
  v.add_common();
}

void declare(CommandFlags v, TrackCommand& c) {
  v.argument("IMAGES", c.inputs, std::string("frames in their order, or one image with frames: ") + label_formats);
  v.output(c.output, "folder for labels_0000.EXT, ..., measures.csv and models");
  declare_segmentation(v, c);
  v.flag("persistence", c.persistence, "P", "1",
         "how strongly noisy frames are drawn to where their neighbours have the contour; 0: not at all")
      ->check(CLI::Range(0.0, 100.0));
  v.positive_flag("motion", c.motion, "VOXELS", "a quarter of the depth of the inside",
                  "the farthest that the contour may move from one frame to the next");
  v.flag("prediction", c.prediction, "P", "1 with one sweep, else 0",
         "where the first sweep expects the contour: 0 where it was, 1 as far again as it moved before")
      ->check(CLI::Range(0.0, 1.0));
  v.flag("sweeps", c.sweeps, "N", "2", "1: forward only; more: back and forth, so that the contour does not lag behind")
      ->check(CLI::Range(1, 100));
  v.flag("format", c.format, "EXT", "that of the images", "extension of the label images, such as nii.gz");
  v.toggle("--slices-are-frames", c.slices_are_frames, "the third axis is time: pages of .tif, .npy arrays [t, y, x]");
  v.add_common();
}

}  // namespace csrbf::app
