#include "engine/reference/reference_state.h"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <map>

#include <fmt/format.h>

#include "engine/core/cache_room.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"

namespace hl {
namespace {

// Files of glossy receivers hold their lobes' sums too; all others are as they were before there were any.
constexpr std::string_view kMagic = "halflight reference 3\n", kMagicWithLobes = "halflight reference 5\n";
static_assert(kMagic.size() == kMagicWithLobes.size());
constexpr size_t kHashDigits = 32;
constexpr const char* kExtension = ".reference";
constexpr uint32_t kMostBuckets = 256;  // in a file: more is damage

struct Header {
  char key[kHashDigits];
  uint32_t receivers, buckets;
  ReferenceCount now, next;
  uint64_t backFaceHits, nonFinite, paths, rays;
};

template <class T>
void append(std::string& bytes, const T* data, size_t count) {
  bytes.append(reinterpret_cast<const char*>(data), count * sizeof(T));
}

size_t payloadBytes(uint64_t receivers, uint64_t buckets, bool lobes) {
  return sizeof(Header) + receivers * ((lobes ? 2 : 1) * ((2 * buckets + 1) * sizeof(vec3) + 2 * sizeof(glm::dvec3)) + 1);
}

bool withLobes(std::string_view bytes) { return bytes.starts_with(kMagicWithLobes); }

/// What the file holds, its length and checksum in order. @throws Error(BadInput) with what is wrong with it.
Header headerOf(std::string_view bytes) {
  if (!bytes.starts_with(kMagic) && !withLobes(bytes)) throw badInput("it is no reference of this version");
  if (bytes.size() < kMagic.size() + kHashDigits + sizeof(Header)) throw badInput(fmt::format("it has {} bytes: it is cut off", bytes.size()));
  const std::string_view hash = bytes.substr(kMagic.size(), kHashDigits), payload = bytes.substr(kMagic.size() + kHashDigits);
  Header h;
  std::memcpy(&h, payload.data(), sizeof h);
  if (h.buckets > kMostBuckets || payload.size() != payloadBytes(h.receivers, h.buckets, withLobes(bytes)))
    throw badInput(fmt::format("its {} bytes are not those of {} receivers with {} buckets", bytes.size(), h.receivers, h.buckets));
  if (hashOf(payload) != hash) throw badInput("its content does not match its checksum");
  return h;
}

std::string_view keyIn(const Header& h) { return {h.key, sizeof h.key}; }

/// @throws Error(BadInput) with what is wrong with the file.
ReferenceState parse(std::string_view bytes, std::string_view key, const ReferenceShape& shape) {
  const Header h = headerOf(bytes);
  if (ReferenceShape{h.receivers, h.buckets, withLobes(bytes)} != shape || keyIn(h) != key) throw badInput("it belongs to other receivers");
  const std::string_view payload = bytes.substr(kMagic.size() + kHashDigits);
  ReferenceState s(shape);
  s.now = h.now, s.next = h.next;
  s.backFaceHits = h.backFaceHits, s.nonFinite = h.nonFinite, s.paths = h.paths, s.rays = h.rays;
  const char* at = payload.data() + sizeof h;
  const auto take = [&at](auto& v) {
    if (v.empty()) return;  // no lobes: memcpy takes no null
    std::memcpy(v.data(), at, v.size() * sizeof v[0]);
    at += v.size() * sizeof v[0];
  };
  for (int half = 0; half < 2; ++half) take(s.indirect[half]), take(s.specular[half]), take(s.extended[half]), take(s.extendedSpecular[half]);
  take(s.punctual), take(s.punctualSpecular);
  take(s.ahead);
  return s;
}

}  // namespace

ReferenceState::ReferenceState(const ReferenceShape& shape) : ReferenceShape(shape) {
  for (int half = 0; half < 2; ++half) {
    if (lobes) specular[half].assign(static_cast<size_t>(receivers) * buckets, vec3(0.0f)), extendedSpecular[half].assign(receivers, glm::dvec3(0.0));
    indirect[half].assign(static_cast<size_t>(receivers) * buckets, vec3(0.0f));
    extended[half].assign(receivers, glm::dvec3(0.0));
  }
  punctual.assign(receivers, vec3(0.0f));
  if (lobes) punctualSpecular.assign(receivers, vec3(0.0f));
  ahead.assign(receivers, 0);
}

std::filesystem::path referenceCacheFile(const std::string& key, uint32_t samples) {
  return cacheFolder() / "references" / fmt::format("{}_{}{}", key, samples, kExtension);
}

void checkReferenceFile(const std::string& name, std::string_view bytes) {
  const Header h = headerOf(bytes);
  const std::string right = referenceCacheFile(std::string(keyIn(h)), h.next.paths).filename().string();
  if (name != right) throw badInput(fmt::format("it is called {} and holds {}", name, right));
}

std::optional<ReferenceState> loadReference(const std::string& key, const ReferenceShape& shape, uint32_t maxSamples, uint32_t pass) {
  namespace fs = std::filesystem;
  std::map<uint32_t, fs::path, std::greater<>> found;  // by samples, most first
  std::error_code ec;
  for (const auto& e : fs::directory_iterator(cacheFolder() / "references", ec)) {
    const std::string stem = e.path().stem().string();
    if (e.path().extension() != kExtension || !stem.starts_with(key + "_")) continue;
    const std::string digits = stem.substr(key.size() + 1);
    uint32_t samples = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), samples);
    if (error != std::errc() || end != digits.data() + digits.size()) continue;
    if (samples == maxSamples || (samples < maxSamples && samples % pass == 0)) found[samples] = e.path();
  }
  for (const auto& [samples, file] : found) {
    try {
      ReferenceState s = parse(readFile(file), key, shape);
      if (s.next.paths != samples) throw badInput("it does not hold the samples that its name says");
      fs::last_write_time(file, fs::file_time_type::clock::now(), ec);  // what was used last goes last
      return s;
    } catch (const Error& e) {
      logWarning(fmt::format("cached reference {} is not used: {}", file.string(), e.what()));
    }
  }
  return std::nullopt;
}

void storeReference(const std::string& key, const ReferenceState& s) {
  Header h{{}, s.receivers, s.buckets, s.now, s.next, s.backFaceHits, s.nonFinite, s.paths, s.rays};
  std::copy_n(key.begin(), std::min(key.size(), sizeof h.key), h.key);
  std::string bytes;
  bytes.reserve(kMagic.size() + kHashDigits + payloadBytes(s.receivers, s.buckets, s.lobes));
  bytes.append(s.lobes ? kMagicWithLobes : kMagic).append(kHashDigits, '0');
  append(bytes, &h, 1);
  for (int half = 0; half < 2; ++half) {
    append(bytes, s.indirect[half].data(), s.indirect[half].size());
    append(bytes, s.specular[half].data(), s.specular[half].size());
    append(bytes, s.extended[half].data(), s.extended[half].size());
    append(bytes, s.extendedSpecular[half].data(), s.extendedSpecular[half].size());
  }
  append(bytes, s.punctual.data(), s.punctual.size());
  append(bytes, s.punctualSpecular.data(), s.punctualSpecular.size());
  append(bytes, s.ahead.data(), s.ahead.size());
  const std::string hash = hashOf(std::string_view(bytes).substr(kMagic.size() + kHashDigits));
  bytes.replace(kMagic.size(), kHashDigits, hash);
  const std::filesystem::path file = referenceCacheFile(key, s.next.paths);
  std::error_code ec;
  std::filesystem::create_directories(file.parent_path(), ec);
  writeFileAtomically(file, bytes);
  makeRoom(file, kReferenceCacheBytes);
}

}  // namespace hl
