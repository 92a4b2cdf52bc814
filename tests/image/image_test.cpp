// Files in and out, bit for bit; broken files; failures that must leave nothing behind.
#include "engine/image/image.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>

#include "engine/error.h"

namespace fs = std::filesystem;
namespace image = radivox::image;

namespace {

class ImageTest : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("radivox_image_" + std::to_string(::getpid()));
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  size_t fileCount() const { return static_cast<size_t>(std::distance(fs::directory_iterator(folder_), fs::directory_iterator())); }
  fs::path folder_;
};

image::Image gradient(uint32_t width, uint32_t height, uint32_t channels) {
  image::Image result{width, height, channels, std::vector<float>(static_cast<size_t>(width) * height * channels)};
  for (size_t i = 0; i < result.data.size(); ++i) result.data[i] = std::sin(static_cast<float>(i)) * 3e4f + 1e-7f;
  return result;
}

std::string slurp(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string errorOf(const std::function<void()>& call, radivox::ErrorCode code = radivox::ErrorCode::BadInput) {
  try {
    call();
  } catch (const radivox::Error& e) {
    EXPECT_EQ(static_cast<int>(e.code()), static_cast<int>(code));
    const std::string what = e.what();
    EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    return what;
  }
  ADD_FAILURE() << "no error";
  return "";
}

TEST_F(ImageTest, ExrKeepsEveryBitOfEveryLayer) {
  const std::vector<image::Layer> written = {
      {"color", gradient(37, 21, 3)}, {"depth", gradient(37, 21, 1)}, {"motion", gradient(37, 21, 2)}, {"tinted", gradient(37, 21, 4)}};
  image::writeExr(path("a.exr"), written);
  const std::vector<image::Layer> read = image::readExr(path("a.exr"));
  ASSERT_EQ(read.size(), written.size());
  for (const image::Layer& layer : written) {
    bool found = false;
    for (const image::Layer& other : read) {
      if (other.name != layer.name) continue;
      found = true;
      EXPECT_EQ(other.image.width, 37u);
      EXPECT_EQ(other.image.height, 21u);
      ASSERT_EQ(other.image.channels, layer.image.channels) << layer.name;
      EXPECT_EQ(std::memcmp(other.image.data.data(), layer.image.data.data(), layer.image.data.size() * 4), 0) << layer.name;
    }
    EXPECT_TRUE(found) << layer.name;
  }
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(ImageTest, ExrKeepsInfinityNotANumberAndSmallestValues) {
  image::Image odd{4, 1, 1, {std::numeric_limits<float>::infinity(), std::nanf(""), std::numeric_limits<float>::denorm_min(), -0.f}};
  image::writeExr(path("odd.exr"), {{"z", odd}});
  const auto read = image::readExr(path("odd.exr"));
  ASSERT_EQ(read.size(), 1u);
  EXPECT_EQ(read[0].name, "z");
  EXPECT_EQ(std::memcmp(read[0].image.data.data(), odd.data.data(), 16), 0);
}

TEST_F(ImageTest, ExrOfTheSameImageIsTheSameFile) {
  image::writeExr(path("a.exr"), {{"color", gradient(16, 16, 3)}});
  image::writeExr(path("b.exr"), {{"color", gradient(16, 16, 3)}});
  EXPECT_EQ(slurp(path("a.exr")), slurp(path("b.exr")));
}

TEST_F(ImageTest, ExrRefusesLayersThatDoNotFitTogether) {
  EXPECT_NE(errorOf([&] {
              image::writeExr(path("a.exr"), {{"color", gradient(4, 4, 3)}, {"depth", gradient(5, 4, 1)}});
            }).find("'depth'"),
            std::string::npos);
  EXPECT_NE(errorOf([&] {
              image::writeExr(path("a.exr"), {{"a", gradient(4, 4, 3)}, {"a", gradient(4, 4, 3)}});
            }).find("twice"),
            std::string::npos);
  EXPECT_NE(errorOf([&] { image::writeExr(path("a.exr"), {}); }).find("no layer"), std::string::npos);
  EXPECT_EQ(fileCount(), 0u);
}

TEST_F(ImageTest, BrokenExrFilesAreOneLineErrors) {
  image::writeExr(path("good.exr"), {{"color", gradient(64, 64, 3)}});
  const std::string good = slurp(path("good.exr"));
  for (const size_t length : {size_t{0}, size_t{3}, size_t{100}, good.size() / 2, good.size() - 1}) {
    std::ofstream(path("cut.exr"), std::ios::binary | std::ios::trunc) << good.substr(0, length);
    EXPECT_NE(errorOf([&] { image::readExr(path("cut.exr")); }).find("cut.exr"), std::string::npos) << length;
  }
  // A data window of 60000 × 60000 in a file of a few kilobytes must not be given the memory.
  std::string huge = good;
  const size_t window = huge.find("dataWindow");
  ASSERT_NE(window, std::string::npos);
  const int32_t side = 59999;
  std::memcpy(huge.data() + window + sizeof("dataWindow") + sizeof("box2i") + 4 + 8, &side, 4);
  std::memcpy(huge.data() + window + sizeof("dataWindow") + sizeof("box2i") + 4 + 12, &side, 4);
  std::ofstream(path("huge.exr"), std::ios::binary) << huge;
  EXPECT_NE(errorOf([&] { image::readExr(path("huge.exr")); }).find("huge.exr"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::readExr(path("none.exr")); }).find("no such file"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::readExr(folder_.string()); }).find("folder"), std::string::npos);
}

TEST_F(ImageTest, PngHoldsTheSrgbCurve) {
  image::Image ramp{256, 1, 3, {}};
  for (int i = 0; i < 256; ++i) {
    // The curve of IEC 61966-2-1, in double.
    const double encoded = i / 255.0;
    const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
    for (int c = 0; c < 3; ++c) ramp.data.push_back(static_cast<float>(linear));
  }
  image::writePng(path("ramp.png"), ramp);
  const image::Image read = image::readPng(path("ramp.png"));
  ASSERT_EQ(read.width, 256u);
  ASSERT_EQ(read.channels, 3u);
  for (uint32_t i = 0; i < 256; ++i) EXPECT_NEAR(image::encodeSrgb(read.at(i, 0, 1)) * 255.f, static_cast<float>(i), 1e-3f);
  for (size_t i = 0; i < ramp.data.size(); ++i) EXPECT_NEAR(read.data[i], ramp.data[i], 1e-6f);
}

TEST_F(ImageTest, PngClampsKeepsAlphaLinearAndNamesThePixelThatIsNotANumber) {
  image::writePng(path("a.png"), image::Image{2, 1, 4, {-1.f, 0.5f, 9.f, 0.5f, 0.f, std::numeric_limits<float>::infinity(), 1.f, 2.f}});
  const image::Image read = image::readPng(path("a.png"));
  ASSERT_EQ(read.channels, 4u);
  EXPECT_EQ(read.at(0, 0, 0), 0.f);
  EXPECT_NEAR(read.at(0, 0, 1), 0.5f, 0.005f);
  EXPECT_EQ(read.at(0, 0, 2), 1.f);
  EXPECT_NEAR(read.at(0, 0, 3), 128.f / 255.f, 1e-6f);
  EXPECT_EQ(read.at(1, 0, 1), 1.f);
  image::Image bad = gradient(8, 8, 3);
  bad.at(5, 6, 1) = std::nanf("");
  EXPECT_NE(errorOf([&] { image::writePng(path("bad.png"), bad); }).find("(5, 6)"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::writePng(path("bad.png"), gradient(4, 4, 2)); }).find("2"), std::string::npos);
  EXPECT_FALSE(fs::exists(path("bad.png")));
  const std::string good = slurp(path("a.png"));
  std::ofstream(path("cut.png"), std::ios::binary) << good.substr(0, 40);
  EXPECT_NE(errorOf([&] { image::readPng(path("cut.png")); }).find("cut.png"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::readPng(path("none.png")); }).find("no such file"), std::string::npos);
}

TEST_F(ImageTest, WritingReplacesAWholeFileOrNothing) {
  image::writeFileAtomically(path("a.txt"), "old");
  ::chmod(path("a.txt").c_str(), 0640);
  // The file size limit is a full disk that a test can have. SIGXFSZ must not end the process.
  const auto old = ::signal(SIGXFSZ, SIG_IGN);
  struct rlimit before {};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  struct rlimit tight = before;
  tight.rlim_cur = 4096;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &tight), 0);
  const std::string error = errorOf([&] { image::writeFileAtomically(path("a.txt"), std::string(100000, 'x')); });
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  ::signal(SIGXFSZ, old);
  EXPECT_NE(error.find("a.txt"), std::string::npos);
  EXPECT_NE(error.find("size limit"), std::string::npos) << error;
  EXPECT_EQ(slurp(path("a.txt")), "old");
  EXPECT_EQ(fileCount(), 1u);
  image::writeFileAtomically(path("a.txt"), "new");
  EXPECT_EQ(slurp(path("a.txt")), "new");
  struct stat info {};
  ASSERT_EQ(::stat(path("a.txt").c_str(), &info), 0);
  EXPECT_EQ(info.st_mode & 07777, 0640u) << "the mode of the replaced file is kept";
  EXPECT_EQ(fileCount(), 1u);
}

TEST_F(ImageTest, UnwritablePlacesAreKnownBeforehand) {
  EXPECT_NE(errorOf([&] { image::checkWritable(path("none/a.exr")); }).find("does not exist"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::writeFileAtomically(path("none/a.exr"), "x"); }).find("does not exist"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::checkWritable(folder_.string()); }).find("folder"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::checkWritable(""); }).find("empty"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::checkWritable("/dev/null"); }).find("not a regular file"), std::string::npos);
  image::writeFileAtomically(path("file"), "x");
  EXPECT_NE(errorOf([&] { image::checkWritable(path("file/a.exr")); }).find("not a folder"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::checkWritable(path(std::string(300, 'n'))); }).find("too long"), std::string::npos);
  // /proc takes no new files, not even root's.
  EXPECT_NE(errorOf([&] { image::checkWritable("/proc/a.exr"); }).find("/proc"), std::string::npos);
  if (::geteuid() != 0) {
    fs::create_directory(path("locked"));
    ::chmod(path("locked").c_str(), 0555);
    EXPECT_NE(errorOf([&] { image::checkWritable(path("locked/a.exr")); }).find("not writable"), std::string::npos);
  }
  image::checkWritable(path("fine.exr"));
  EXPECT_FALSE(fs::exists(path("fine.exr")));
}

TEST_F(ImageTest, LinksAreFollowed) {
  image::writeFileAtomically(path("real"), "old");
  fs::create_symlink("real", path("link"));
  image::writeFileAtomically(path("link"), "new");
  EXPECT_TRUE(fs::is_symlink(path("link")));
  EXPECT_EQ(slurp(path("real")), "new");
}

TEST(Metrics, ExposurePutsThe99thPercentileAtOne) {
  // Luminances 0 … 100 in a shuffled order: the 99th percentile is 99.
  image::Image ramp{101, 1, 3, {}};
  for (int i = 0; i < 101; ++i) {
    for (int c = 0; c < 3; ++c) ramp.data.push_back(static_cast<float>((i * 37) % 101));
  }
  EXPECT_NEAR(image::exposureOf(ramp), 1.f / 99.f, 1e-8f);
  // Two values: a percentile between them is interpolated: 1 + 0.99 · (3 − 1).
  EXPECT_NEAR(image::exposureOf(image::Image{2, 1, 1, {3.f, 1.f}}), 1.f / 2.98f, 1e-6f);
  EXPECT_EQ(image::exposureOf(image::Image{2, 1, 1, {0.f, 0.f}}), 1.f);
  EXPECT_EQ(image::exposureOf(image::Image{1, 1, 3, {std::nanf(""), 1.f, 1.f}}), 1.f);
  // Rec. 709 weights.
  EXPECT_NEAR(image::exposureOf(image::Image{1, 1, 3, {1.f, 2.f, 3.f}}), 1.f / (0.2126f + 2.f * 0.7152f + 3.f * 0.0722f), 1e-6f);
  const image::Image twice = image::scaled(ramp, 2.f);
  EXPECT_EQ(twice.data[3], 2.f * ramp.data[3]);
}

TEST(Metrics, BlockMeansCropAndAverage) {
  image::Image a{5, 4, 2, {}};
  for (int i = 0; i < 40; ++i) a.data.push_back(static_cast<float>(i));
  const image::Image b = image::blockMeans(a, 2);
  ASSERT_EQ(b.width, 2u);
  ASSERT_EQ(b.height, 2u);
  ASSERT_EQ(b.channels, 2u);
  for (uint32_t y = 0; y < 2; ++y) {
    for (uint32_t x = 0; x < 2; ++x) {
      for (uint32_t c = 0; c < 2; ++c) {
        const float mean =
            (a.at(2 * x, 2 * y, c) + a.at(2 * x + 1, 2 * y, c) + a.at(2 * x, 2 * y + 1, c) + a.at(2 * x + 1, 2 * y + 1, c)) / 4;
        EXPECT_EQ(b.at(x, y, c), mean);
      }
    }
  }
  EXPECT_EQ(image::meanOf(a), 19.5);
  EXPECT_EQ(image::meanOf(image::Image{}), 0.0);
}

TEST(Metrics, PsnrOfAKnownDifference) {
  // Two grey pixels at 1 set the exposure to 1; encoded values 1 and 0.5 differ by 0.5 on half of the pixels: MSE 1/8.
  const image::Image a{2, 1, 1, {1.f, 1.f}};
  const image::Image b{2, 1, 1, {1.f, image::decodeSrgb(0.5f)}};
  EXPECT_NEAR(image::psnr(a, b), -10.0 * std::log10(0.125), 1e-5);
  EXPECT_TRUE(std::isinf(image::psnr(a, a)));
  EXPECT_NE(errorOf([&] { image::psnr(a, image::Image{1, 1, 1, {1.f}}); }).find("2x1"), std::string::npos);
  EXPECT_NE(errorOf([&] { image::psnr(a, image::Image{2, 1, 1, {1.f, std::nanf("")}}); }).find("(1, 0)"), std::string::npos);
  // Exposure is the reference's: scaling both changes nothing.
  EXPECT_NEAR(image::psnr(image::scaled(a, 7.f), image::scaled(b, 7.f)), image::psnr(a, b), 1e-4);
}

TEST(Metrics, IndependentRendersAgreeAsPublished) {
  const char* shared = std::getenv("RADIVOX_SHARED");
  const fs::path folder = fs::path(shared != nullptr ? shared : RADIVOX_SOURCE_DIR "/../shared") / "truth";
  if (!fs::exists(folder / "sponza_b8_a.exr")) GTEST_SKIP() << "no " << folder;
  const auto load = [&folder](const char* name) {
    for (image::Layer& layer : image::readExr((folder / name).string())) {
      if (layer.name == "irradiance_indirect") return std::move(layer.image);
    }
    return image::Image{};
  };
  const image::Image a = load("sponza_b8_a.exr"), b = load("sponza_b8_b.exr");
  ASSERT_EQ(a.width, 640u);
  ASSERT_EQ(a.channels, 3u);
  // The figure that comes with the files: 37.6 dB on 4×4 block means.
  EXPECT_NEAR(image::psnr(image::blockMeans(a, 4), image::blockMeans(b, 4)), 37.6, 0.3);
}

}  // namespace
