#include "curve.hpp"
#include "heart.hpp"

#include "csrbf/implicit/preview.hpp"
#include "csrbf/io/image.hpp"
#include "csrbf/levelset/track.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>

namespace {

using csrbf::Index;

constexpr const char* usage =
    "usage: csrbf-beating-heart FOLDER\n\n"
    "Tracks the cavity of a beating left ventricle through noisy images, in 2D and 3D, with and without memory from\n"
    "frame to frame, and compares volumes and labels with the truth. Writes volumes.csv, volumes.svg, frames.png. The\n"
    "exit status is 1 if the ejection fraction is off by more than 4 % or the memory does not help in noise.\n";

// How one tracking agrees with the truth.
struct Agreement {
  std::vector<double> volumes, dice;
  double mean_dice = 0, worst_dice = 1, ejection_fraction = 0;
  double roughness = 0;  // rms of the second differences of the errors of the volumes, over the largest volume
};

double ejection_fraction(const std::vector<double>& volumes) {
  const auto [least, most] = std::minmax_element(volumes.begin(), volumes.end());
  return 1 - *least / *most;
}

std::vector<double> true_volumes(const Heart& heart) {
  std::vector<double> volumes;
  for (Index t = 0; t < heart.frames; ++t)
    volumes.push_back(cavity_volume(heart, static_cast<double>(t) / static_cast<double>(heart.frames)));
  return volumes;
}

double dice(const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b) {
  double both = 0, sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    both += a[i] != 0 && b[i] != 0 ? 1 : 0;
    sum += (a[i] != 0 ? 1 : 0) + (b[i] != 0 ? 1 : 0);
  }
  return 2 * both / sum;
}

template <int Dim>
Agreement compare(const Heart& heart, const csrbf::Tracking<Dim>& tracking) {
  Agreement result;
  const std::vector<double> truth = true_volumes(heart);
  std::vector<double> errors;
  for (Index t = 0; t < heart.frames; ++t) {
    const auto& frame = tracking.frames[t];
    result.volumes.push_back(frame.regions[0].volume);
    result.dice.push_back(dice(frame.segmentation.labels, true_labels(heart, t)));
    errors.push_back((result.volumes.back() - truth[t]) / truth[0]);
  }
  for (const double value : result.dice) {
    result.mean_dice += value / static_cast<double>(heart.frames);
    result.worst_dice = std::min(result.worst_dice, value);
  }
  double squares = 0;
  for (std::size_t t = 1; t + 1 < errors.size(); ++t)
    squares += std::pow(errors[t - 1] - 2 * errors[t] + errors[t + 1], 2);
  result.roughness = std::sqrt(squares / static_cast<double>(errors.size() - 2));
  result.ejection_fraction = ejection_fraction(result.volumes);
  return result;
}

// From a disc in the middle of the cavity; the contour grows to the wall, and what it encloses, as the papillary
// muscles, counts as cavity. In global mode they do not, and bright spots anywhere do.
template <int Dim>
csrbf::TrackOptions make_options(const Heart& heart, const csrbf::Grid& grid, csrbf::SegmentMode mode) {
  constexpr double phase = 0, seed_depth = 12;  // mm
  csrbf::TrackOptions options;
  options.segment.mode = mode;
  const csrbf::Points<3> centers = grid.centers<3>();
  for (const auto& p : centers.colwise())
    options.segment.seed.push_back(cavity_depth(heart, p, phase) > seed_depth ? 1 : 0);
  return options;
}

void say(const char* what, const Agreement& a, double truth) {
  std::printf("%-34s  %5.1f (true %.1f)  %.4f  %.4f  %5.2f\n", what, 100 * a.ejection_fraction, 100 * truth,
              a.mean_dice, a.worst_dice, 100 * a.roughness);
}

csrbf::RgbImage side_by_side(const std::vector<csrbf::RgbImage>& pictures) {
  csrbf::RgbImage row(0, pictures[0].height);
  for (const csrbf::RgbImage& picture : pictures) row.width += picture.width;
  row.pixels.resize(3 * row.width * row.height);
  std::ptrdiff_t at = 0;
  for (const csrbf::RgbImage& picture : pictures) {
    for (std::ptrdiff_t y = 0; y < row.height; ++y)
      std::copy_n(picture.pixels.begin() + 3 * y * picture.width, 3 * picture.width,
                  row.pixels.begin() + 3 * (y * row.width + at));
    at += picture.width;
  }
  return row;
}

void draw(const std::string& path, const csrbf::Volume<float>& sequence, const csrbf::Tracking<2>& tracking) {
  std::vector<csrbf::RgbImage> pictures;
  for (const Index t : {Index{0}, sequence.frames / 6, sequence.frames / 3}) {
    const auto& segmentation = tracking.frames[t].segmentation;
    csrbf::PreviewOptions look;
    look.frame = t;
    look.size = 256;
    pictures.push_back(csrbf::preview<2>(sequence, {segmentation.fields[0].get()}, look));
  }
  csrbf::write_png(path, side_by_side(pictures));
}

struct Trial {
  Agreement alone, remembered;
};

// One sequence without and with memory.
template <int Dim>
Trial track_both(const Heart& heart, const csrbf::Volume<float>& sequence, const std::string& name,
                 csrbf::SegmentMode mode, csrbf::Tracking<Dim>* tracking = nullptr) {
  csrbf::TrackOptions options = make_options<Dim>(heart, sequence.grid, mode);
  const double truth = ejection_fraction(true_volumes(heart));
  const double persistence = options.persistence;
  Trial trial;
  options.persistence = 0;
  trial.alone = compare(heart, csrbf::track<Dim>(sequence, options));
  say((name + ", alone").c_str(), trial.alone, truth);
  options.persistence = persistence;
  csrbf::Tracking<Dim> remembered = csrbf::track<Dim>(sequence, options);
  trial.remembered = compare(heart, remembered);
  say((name + ", with memory").c_str(), trial.remembered, truth);
  if (tracking != nullptr) *tracking = std::move(remembered);
  return trial;
}

int run(const std::filesystem::path& folder) {
  constexpr double largest_error = 0.04;  // of the ejection fraction
  constexpr double lost_dice = 0.0025;    // where the heart turns, the neighbours of a frame are beside it
  std::filesystem::create_directories(folder);
  const auto file = [&](const char* name) { return (folder / name).string(); };
  bool good = true;
  const auto check = [&](const Heart& heart, const Trial& trial, bool noisy) {
    const double truth = ejection_fraction(true_volumes(heart));
    good = good && std::abs(trial.remembered.ejection_fraction - truth) < largest_error;
    if (noisy)
      good = good && trial.remembered.roughness < trial.alone.roughness &&
             trial.remembered.mean_dice > trial.alone.mean_dice - lost_dice;
  };
  std::printf("%-34s  %-19s  %-6s  %-6s  %s\n", "", "ejection fraction %", "Dice", "worst", "roughness %");
  using enum csrbf::SegmentMode;
  Trial last;
  Heart slice;
  for (const double decibels : {20.0, 10.0, 5.0}) {
    slice.decibels = decibels;
    const csrbf::Volume<float> sequence = make_sequence(slice);
    csrbf::Tracking<2> tracking;
    last = track_both<2>(slice, sequence, "slice, " + std::to_string(static_cast<int>(decibels)) + " dB", local,
                         &tracking);
    check(slice, last, false);
    if (decibels == 5) draw(file("frames.png"), sequence, tracking);
  }
  Heart speckled = slice;
  speckled.noise = Noise::speckle;
  check(speckled, track_both<2>(speckled, make_sequence(speckled), "slice, speckle", local), true);
  Heart dark = slice;
  dark.decibels = 0;
  const Trial darkest = track_both<2>(dark, make_sequence(dark), "slice, 0 dB, global", global);
  check(dark, darkest, true);
  Heart space{.dimension = 3, .size = 48, .frames = 8, .voxel = 2.4, .decibels = 10};
  check(space, track_both<3>(space, make_sequence(space), "volume, 10 dB", local), false);

  const std::vector<Curve> curves{{"true", "#222222", true_volumes(dark)},
                                  {"alone", "#d9820a", darkest.alone.volumes},
                                  {"with memory", "#1a5fb4", darkest.remembered.volumes}};
  write_svg(file("volumes.svg"), "Area of the cavity at 0 dB (mm2) over the frames of a beat", curves);
  write_csv(file("volumes.csv"), curves);

  std::printf("\nDice of the frames of the slice at 5 dB, with memory:\n");
  for (std::size_t t = 0; t < last.remembered.dice.size(); ++t)
    std::printf("%.4f%s", last.remembered.dice[t], t % 8 == 7 || t + 1 == last.remembered.dice.size() ? "\n" : " ");
  return good ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || argv[1][0] == '-') {
    const bool asked = argc == 2 && (std::string(argv[1]) == "--help" || std::string(argv[1]) == "-h");
    std::fputs(usage, asked ? stdout : stderr);
    return asked ? 0 : 2;
  }
  try {
    return run(argv[1]);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "csrbf-beating-heart: %s\n", error.what());
    return 1;
  }
}
