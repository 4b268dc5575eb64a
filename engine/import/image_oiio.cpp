#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "engine/core/error.h"
#include "engine/core/image_formats.h"
#include "engine/core/log.h"

namespace hl {

namespace {

constexpr long long kMostValues = 1LL << 31;  // 8 GiB of floats; a header that asks for more is taken for damage

/// No thread pools of its own: nothing of ours may run beside a frame that is timed.
void limitThreads() {
  static const bool done = [] {
    OIIO::attribute("threads", 1);
    OIIO::attribute("exr_threads", -1);
    return true;
  }();
  static_cast<void>(done);
}

/// One line: libraries end theirs with a line break, or write several.
std::string oneLine(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == '.')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

float linearOfSrgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

void undoSrgb(Image& image, int alphaChannel) {
  for (size_t i = 0; i < image.data.size(); ++i)
    if (static_cast<int>(i % static_cast<size_t>(image.channels)) != alphaChannel)
      image.data[i] = linearOfSrgb(image.data[i]);
}

/// libjpeg fills what is missing with grey and only warns; libpng says its own line on stderr and jumps over
/// destructors. So a file that does not end with its format's end marker never reaches them. Some writers pad behind
/// the marker.
bool endsWith(const std::filesystem::path& file, std::string_view marker) {
  std::ifstream in(file, std::ios::binary | std::ios::ate);
  const std::streamoff size = in.tellg();
  const std::streamoff tail = std::min<std::streamoff>(size, 4096);
  std::string bytes(static_cast<size_t>(std::max<std::streamoff>(tail, 0)), '\0');
  in.seekg(size - tail);
  in.read(bytes.data(), tail);
  return bytes.rfind(marker) != std::string::npos;
}

bool cutOff(const std::filesystem::path& file, std::string_view format) {
  if (format == "jpeg") return !endsWith(file, "\xff\xd9");
  if (format == "png") return !endsWith(file, "IEND\xae\x42\x60\x82");
  return false;
}

/// Text chunks are Latin-1 in PNG and bytes in EXR: only ASCII means the same in both.
std::string asciiOf(const std::string& key, std::string text, const std::filesystem::path& shown) {
  size_t replaced = 0;
  for (char& c : text)
    if (static_cast<unsigned char>(c) > 126 || c == '\0') c = '?', ++replaced;
  if (replaced > 0)
    logWarning(fmt::format("{}: {} bytes of the attribute '{}' are not ASCII and were written as '?'", shown.string(),
                           replaced, key));
  return text;
}

}  // namespace

extern "C" Image halflight_read_image(const std::filesystem::path& file, bool srgbToLinear) {
  limitThreads();
  OIIO::ImageSpec asStored;
  asStored.attribute("oiio:UnassociatedAlpha", 1);  // else colours come back multiplied by alpha
  const auto in = OIIO::ImageInput::open(file.string(), &asStored);
  if (!in) throw badInput(fmt::format("{}: not a readable image: {}", file.string(), oneLine(OIIO::geterror())));
  const OIIO::ImageSpec& spec = in->spec();
  const long long values = static_cast<long long>(spec.width) * spec.height * spec.nchannels;
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.depth > 1 || values > kMostValues)
    throw badInput(fmt::format("{}: {} x {} x {} pixels of {} channels are no image this program reads", file.string(),
                               spec.width, spec.height, spec.depth, spec.nchannels));
  if (cutOff(file, in->format_name()))
    throw badInput(fmt::format("{}: cut off: the end marker of its format is missing", file.string()));
  Image image(spec.width, spec.height, spec.nchannels);
  if (!in->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, image.data.data()))
    throw badInput(fmt::format("{}: cut off or damaged: {}", file.string(), oneLine(in->geterror())));
  for (const OIIO::ParamValue& attribute : spec.extra_attribs)
    if (attribute.type() == OIIO::TypeDesc::STRING) image.metadata[attribute.name().string()] = attribute.get_string();
  const bool coded = spec.format == OIIO::TypeDesc::UINT8 || spec.format == OIIO::TypeDesc::UINT16;
  if (srgbToLinear && coded) undoSrgb(image, spec.alpha_channel);
  return image;
}

extern "C" void halflight_write_image(const std::filesystem::path& to, const std::filesystem::path& shown, const Image& image) {
  limitThreads();
  const bool png = to.extension() == ".png" || to.extension() == ".PNG";
  OIIO::ImageSpec spec(image.width, image.height, image.channels, png ? OIIO::TypeDesc::UINT8 : OIIO::TypeDesc::FLOAT);
  if (png && image.channels > 4)
    throw badInput(fmt::format("{}: PNG holds 1 to 4 channels, not {}", shown.string(), image.channels));
  for (const auto& [key, text] : image.metadata) spec.attribute(key, asciiOf(key, text, shown));
  spec.attribute("oiio:UnassociatedAlpha", 1);
  spec.attribute("oiio:ColorSpace", png ? "sRGB" : "Linear");
  const auto failed = [&](std::string reason) {
    return Error(ErrorKind::Run, fmt::format("{}: cannot be written: {}", shown.string(), oneLine(std::move(reason))));
  };
  const auto out = OIIO::ImageOutput::create(to.string());
  if (!out) throw failed(OIIO::geterror());
  if (!out->open(to.string(), spec)) throw failed(out->geterror());
  if (!out->write_image(OIIO::TypeDesc::FLOAT, image.data.data())) throw failed(out->geterror());
  if (!out->close()) throw failed(out->geterror());
}

}  // namespace hl
