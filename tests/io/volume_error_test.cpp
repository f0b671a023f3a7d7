#include "csrbf/io/files/npy.hpp"
#include "csrbf/io/volume.hpp"

#include "io/io_testing.hpp"

namespace csrbf::volume_error_test {
namespace {

using testing::content;
using testing::io_error;
using testing::TemporaryFolder;

class Errors {
 public:
  // The message of reading a file of these bytes, without the folder.
  std::string reading(const std::string& name, const std::string& bytes) const {
    // Some file systems wait for the disk when a file is replaced.
    std::filesystem::remove(folder_.file(name));
    const std::string path = folder_.with(name, bytes);
    return without_folder(io_error([&] { read_volume(path); }));
  }
  template <class Scalar>
  std::string writing(const std::string& name, const Volume<Scalar>& volume) const {
    return without_folder(io_error([&] { write_volume(folder_.file(name), volume); }));
  }
  // The bytes of an image of 5 x 4 x 3 numbers in the format.
  std::string written(const std::string& name) const {
    VolumeLayout layout;
    const bool flat = name.ends_with(".png") || name.ends_with(".pgm");
    layout.grid.size = {5, 4, flat ? 1 : 3};
    layout.type = SampleType::uint16;
    Volume<float> volume(layout);
    for (std::size_t i = 0; i < volume.values.size(); ++i) volume.values[i] = static_cast<float>(i * i);
    write_volume(folder_.file(name), volume);
    return content(folder_.file(name));
  }

 private:
  std::string without_folder(std::string message) const {
    const std::string folder = folder_.folder() + "/";
    return message.starts_with(folder) ? message.substr(folder.size()) : message;
  }
  TemporaryFolder folder_;
};

// The damaged name of a data file is the name of another file.
bool names_another_file(const std::string& message) {
  return message.find(": cannot read the file") != std::string::npos;
}

constexpr std::array<const char*, 8> names{"a.png", "a.pgm", "a.tif", "a.nii", "a.nii.gz", "a.nrrd", "a.mha", "a.npy"};

TEST(ReadVolume, RefusesFilesThatEndTooEarlyWhereverTheyDo) {
  const Errors errors;
  for (const char* name : names) {
    const std::string bytes = errors.written(name);
    // The last bytes of .png hold no sample.
    const std::size_t needed = bytes.size() - (std::string(name) == "a.png" ? 12 : 0);
    for (std::size_t size = 0; size < needed; ++size) {
      const std::string message = errors.reading(name, bytes.substr(0, size));
      EXPECT_TRUE(message.starts_with(name) || names_another_file(message))
          << name << " cut to " << size << ": " << message;
    }
  }
}

TEST(ReadVolume, SurvivesDamagedBytesInHeaders) {
  const Errors errors;
  for (const char* name : names) {
    const std::string bytes = errors.written(name);
    for (std::size_t at = 0; at < std::min<std::size_t>(bytes.size(), 400); ++at) {
      std::string damaged = bytes;
      damaged[at] = std::array{'\0', '\x7f', '\xff'}[at % 3];
      const std::string message = errors.reading(name, damaged);
      EXPECT_TRUE(message == "no exception" || message.starts_with(name) || names_another_file(message))
          << name << " at " << at << ": " << message;
    }
  }
}

TEST(ReadVolume, RefusesFilesOfAnotherKind) {
  const Errors errors;
  EXPECT_EQ(errors.reading("a.png", "GIF89a..."), "a.png: not a .png file");
  EXPECT_EQ(errors.reading("a.pgm", "P4 1 1\n"), "a.pgm: not a .pgm or .ppm file: it must begin with P2, P3, P5 or P6");
  EXPECT_EQ(errors.reading("a.tif", "GIF89a..."), "a.tif: not a TIFF file");
  EXPECT_EQ(errors.reading("a.nii", "GIF89a..."),
            "a.nii: not a NIfTI file: it must begin with the header's size, 348 or 540");
  EXPECT_EQ(errors.reading("a.nrrd", "GIF89a..."),
            "a.nrrd: not a NRRD file: it must begin with NRRD000 and the version");
  EXPECT_EQ(errors.reading("a.mha", "GIF89a..."), "a.mha:1: expected \"name = value\", found \"GIF89a...\"");
  EXPECT_EQ(errors.reading("a.npy", "GIF89a..."), "a.npy: not a .npy file");
  for (const char* name : names) EXPECT_EQ(errors.reading(name, ""), std::string(name) + ": the file is empty");
  EXPECT_EQ(
      io_error([] { read_volume("a.gif"); }),
      "a.gif: unknown extension \".gif\"; images are .png .pgm .ppm .jpg .jpeg .bmp .tif .tiff .nii .nii.gz .nrrd "
      ".mha .mhd .npy .vti .asc .nc, and DICOM files or folders");
  EXPECT_EQ(io_error([] { read_volume("missing.png"); }),
            "missing.png: cannot read the file: No such file or directory");
}

TEST(ReadVolume, RefusesHugeHeadersBeforeItTakesMemory) {
  const Errors errors;
  EXPECT_EQ(errors.reading("a.pgm", "P5 100000 100000 255\n123"),
            "a.pgm: the file is truncated: its header promises 10000000000 bytes of samples, it can hold 3");
  EXPECT_EQ(errors.reading("a.pgm", "P2 100000 100000 255\n1 2 3"),
            "a.pgm: the file is truncated: its header promises 10000000000 bytes of samples, it can hold 3");
  EXPECT_EQ(errors.reading("a.nrrd",
                           "NRRD0004\ntype: float\ndimension: 3\nsizes: 100000 100000 10\n"
                           "encoding: gzip\n\n1234567890"),
            "a.nrrd: the file is truncated: its header promises 400000000000 bytes of samples, it can hold 11000");
  EXPECT_EQ(errors.reading("a.nrrd",
                           "NRRD0004\ntype: float\ndimension: 3\nsizes: 1000000 1000000 1000000\n"
                           "encoding: raw\n\n1234567890"),
            "a.nrrd: the header promises more than 2^40 samples");
  EXPECT_EQ(errors.reading("a.mha",
                           "NDims = 3\nDimSize = 1000000 1000000 1000000\nElementType = MET_UCHAR\n"
                           "ElementDataFile = LOCAL\n1"),
            "a.mha: the header promises more than 2^40 samples");
  std::string nifti = errors.written("a.nii");
  for (const std::size_t at : {42u, 44u, 46u}) nifti[at + 1] = 0x7f;
  EXPECT_TRUE(errors.reading("a.nii", nifti).starts_with("a.nii: the header promises more than 2^40 samples"));
  EXPECT_TRUE(errors.reading("a.npy", format_npy_header(SampleType::float64, {1000000, 1000000}))
                  .starts_with("a.npy: the file is truncated: its header promises 8000000000000 bytes of samples"));
  std::string png = errors.written("a.png");
  png[17] = png[21] = 0x0f;  // width and height; the checksum is wrong as well
  EXPECT_TRUE(errors.reading("a.png", png).starts_with("a.png: cannot read the picture"));
}

TEST(ReadVolume, NamesTheTypesAndFieldsThatItDoesNotSupport) {
  const Errors errors;
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: block\n\n"),
            "a.nrrd:2: samples of type \"block\" are not supported; int8 to uint64, float and double are");
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: float\ndimension: 9\n\n"),
            "a.nrrd:3: \"9\" is not a whole number from 1 to 5");
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: float\nencoding: bzip2\n\n"),
            "a.nrrd:3: encoding \"bzip2\" is not supported; raw, gzip and ascii are");
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: float\ndimension: 2\nsizes: 3\n\n"),
            "a.nrrd:4: expected one item for each of 2 axes");
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: float\nencoding: raw\n\n"),
            "a.nrrd: the header has no field \"sizes\"");
  EXPECT_EQ(errors.reading("a.nrrd",
                           "NRRD0004\ntype: uchar\ndimension: 3\nsizes: 1 1 1\nencoding: raw\nspace: LPS\n"
                           "space directions: (1,0,0) (1,0,0) (0,0,1)\n\n1"),
            "a.nrrd: the axes of the image lie in one plane: its directions are singular");
  EXPECT_EQ(errors.reading("a.nrrd", "NRRD0004\ntype: uchar\ndimension: 1\nsizes: 2\nencoding: ascii\n\n1 x"),
            "a.nrrd: sample 2: \"x\" is not a number");
  EXPECT_EQ(errors.reading("a.mha", "NDims = 2\nDimSize = 3\n"), "a.mha:2: expected 2 numbers, found 1");
  EXPECT_EQ(
      errors.reading("a.mha", "NDims = 2\nDimSize = 2 2\nNDims = 3\nElementType = MET_UCHAR\nElementDataFile = LOCAL"),
      "a.mha:3: NDims appears twice");
  EXPECT_EQ(errors.reading("a.mha", "NDims = 1\nDimSize = 1\nElementType = MET_UCHAR\nElementDataFile = /dev/null\n"),
            "/dev/null: the data of an image must be in a regular file");
  EXPECT_EQ(errors.reading("a.mha", "NDims = 2\nElementType = MET_STRING\n"),
            "a.mha:2: samples of type \"MET_STRING\" are not supported; MET_UCHAR to MET_DOUBLE are");
  EXPECT_EQ(errors.reading("a.mha", "NDims = 2\nElementDataFile = LIST\n"),
            "a.mha:2: images in several files are not supported, found \"LIST\"");
  EXPECT_EQ(errors.reading("a.mha", "NDims = 2\n"), "a.mha: the header ends without ElementDataFile");
  EXPECT_EQ(errors.reading("a.pgm", "P2 2 1 9\n3\n10\n"), "a.pgm:3: \"10\" is not a sample from 0 to 9");
  EXPECT_EQ(errors.reading("a.pgm", "P5 2 0 9\n"), "a.pgm:1: \"0\" is not a height from 1 to 2147483648");
  std::string npy = format_npy_header(SampleType::float64, {2});
  npy.replace(npy.find("f8"), 2, "c8");
  EXPECT_EQ(errors.reading("a.npy", npy), "a.npy: elements of type \"<c8\" are not supported; save float64");
  EXPECT_EQ(
      errors.reading("a.npy", format_npy_header(SampleType::uint8, {})),
      "a.npy: an array of 0 axes is no image; images are [x], [y, x], [z, y, x] or [t, z, y, x], then components");
  std::string nifti = errors.written("a.nii");
  nifti[70] = 32;
  nifti[71] = 0;
  EXPECT_EQ(errors.reading("a.nii", nifti),
            "a.nii: samples of NIfTI datatype 32 are not supported; integers, float32, float64 and RGB are");
  nifti[345] = 'i';
  EXPECT_EQ(errors.reading("a.nii", nifti),
            "a.nii: only the header of a .hdr and .img pair; convert it to a single .nii file");
}

TEST(ReadVolume, FindsDamageByTheChecksums) {
  const Errors errors;
  std::string bytes = errors.written("a.nii.gz");
  bytes[bytes.size() - 6] = static_cast<char>(bytes[bytes.size() - 6] ^ 1);
  EXPECT_EQ(errors.reading("a.nii.gz", bytes), "a.nii.gz: the compressed data are damaged: incorrect data check");
}

TEST(WriteVolume, SaysWhatAFormatCannotHold) {
  const Errors errors;
  VolumeLayout layout;
  layout.grid.size = {4, 3, 2};
  layout.type = SampleType::uint8;
  EXPECT_EQ(errors.writing("a.png", Volume<float>(layout)),
            "a.png: .png files hold no third axis; write .nii.gz, .nrrd or .npy");
  layout.frames = 2;
  EXPECT_EQ(errors.writing("a.tif", Volume<float>(layout)),
            "a.tif: .tif files hold no sequences of three axes; write .nii.gz, .nrrd or .npy");
  layout.grid.size[2] = 1;
  EXPECT_EQ(errors.writing("a.pgm", Volume<float>(layout)),
            "a.pgm: .pgm files hold no time axis; write .nii.gz, .nrrd or .npy");
  layout.frames = 1;
  layout.components = 2;
  EXPECT_EQ(errors.writing("a.ppm", Volume<float>(layout)),
            "a.ppm: .ppm files hold no pixels of 2 components; write .nii.gz, .nrrd or .npy");
  layout.components = 1;
  layout.type = SampleType::float32;
  EXPECT_EQ(errors.writing("a.png", Volume<float>(layout)),
            "a.png: .png files hold whole numbers, the image holds float32; write .tif, .nii.gz, .nrrd or .npy");
  layout.type = SampleType::int16;
  EXPECT_EQ(errors.writing("a.png", Volume<float>(layout, -2)),
            "a.png: .png files hold whole numbers from 0 to 65535, the image reaches from -2.000000 to -2.000000; "
            "write .tif, .nii.gz, .nrrd or .npy");
  EXPECT_THROW(write_volume("a.npy", Volume<float>()), InvalidInput);
  EXPECT_TRUE(errors.writing("none/a.npy", Volume<float>(layout)).ends_with("No such file or directory"));
}

}  // namespace
}  // namespace csrbf::volume_error_test
