#include "engine/techniques/srp/store.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "engine/core/byte_stream.h"
#include "engine/core/cache_room.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"
#include "engine/core/log.h"

namespace hl {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic = "halflight transport 5\n";

std::string header(const std::string& key) { return std::string(kMagic) + key + "\n"; }

std::string encode(const ClusterTransport& c) {
  ByteWriter w;
  w.value(c.receivers), w.value(c.wide), w.value(c.rows), w.value(c.columns), w.value(c.rank);
  w.array(c.basis), w.array(c.weights), w.array(c.valid), w.array(c.readsOf), w.array(c.reads);
  w.value(c.coarse), w.value(c.scarce), w.value(c.total), w.value(c.discarded);
  return w.take();
}

ClusterTransport decode(std::string_view bytes) {
  ByteReader r(bytes);
  ClusterTransport c;
  c.receivers = r.value<uint32_t>(), c.wide = r.value<uint32_t>(), c.rows = r.value<uint32_t>(), c.columns = r.value<uint32_t>(), c.rank = r.value<uint32_t>();
  r.array(c.basis), r.array(c.weights), r.array(c.valid), r.array(c.readsOf), r.array(c.reads);
  c.coarse = r.value<double>(), c.scarce = r.value<double>(), c.total = r.value<double>(), c.discarded = r.value<double>();
  uint64_t reads = 0;
  for (uint32_t n : c.readsOf) reads += n;
  const uint64_t basis = c.basis.empty() ? 0 : uint64_t{c.rank} * c.columns;
  if (!r.atEnd() || c.rows < 1 || c.wide > c.receivers || c.basis.size() != basis || c.weights.size() != (c.receivers + (uint64_t{c.rows} - 1) * c.wide) * c.rank || c.valid.size() != c.receivers ||
      (!c.readsOf.empty() && c.readsOf.size() != c.receivers) || c.reads.size() != reads)
    throw std::out_of_range("sizes");
  return c;
}

/// Before each cluster: its number, its size, its digest.
constexpr size_t kDigest = 32, kFront = 2 * sizeof(uint64_t) + kDigest;

[[noreturn]] void fail(const fs::path& file, const char* what) { throw Error(ErrorKind::Run, file.string() + ": " + what + ": " + std::strerror(errno)); }

}  // namespace

TransportStore::TransportStore(const std::string& key) : file_(cacheFolder() / "transport" / (key + ".hlt")), key_(key) {}

TransportStore::~TransportStore() {
  if (descriptor_ >= 0) close(descriptor_);
}

/// Whether the file is this process's to write.
bool TransportStore::lock() {
  if (descriptor_ >= 0 || refused_) return descriptor_ >= 0;
  std::error_code ec;
  fs::create_directories(file_.parent_path(), ec);
  makeRoom(file_, kMostStoredBytes);
  descriptor_ = open(file_.c_str(), O_RDWR | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (descriptor_ < 0) fail(file_, "can't be opened");
  if (flock(descriptor_, LOCK_EX | LOCK_NB) == 0) return true;
  close(descriptor_);
  descriptor_ = -1;
  refused_ = true;
  return false;
}

size_t TransportStore::count(size_t clusters) const {
  std::error_code ec;
  const uint64_t bytes = fs::is_regular_file(file_, ec) ? fs::file_size(file_, ec) : 0;
  std::ifstream in(file_, std::ios::binary);
  const std::string head = header(key_);
  std::string found(head.size(), '\0');
  if (ec || !in.read(found.data(), static_cast<std::streamsize>(found.size())) || found != head) return 0;
  size_t whole = 0;
  for (uint64_t at = head.size(); whole < clusters && bytes - at >= kFront; ++whole) {
    uint64_t front[2];  // the cluster's number, and its size
    in.seekg(static_cast<std::streamoff>(at));
    if (!in.read(reinterpret_cast<char*>(front), sizeof front) || front[0] != whole || front[1] > bytes - at - kFront) break;
    at += kFront + front[1];
  }
  return whole;
}

std::vector<ClusterTransport> TransportStore::read(size_t clusters) {
  std::vector<ClusterTransport> found;
  std::error_code ec;
  if (!fs::is_regular_file(file_, ec)) return found;
  const std::string bytes = readFile(file_);
  const std::string head = header(key_);
  size_t good = 0;
  if (std::string_view(bytes).substr(0, head.size()) == head) {
    good = head.size();
    while (found.size() < clusters && bytes.size() - good >= kFront) {
      uint64_t number = 0, size = 0;
      std::memcpy(&number, bytes.data() + good, sizeof number);
      std::memcpy(&size, bytes.data() + good + sizeof number, sizeof size);
      if (number != found.size() || size > bytes.size() - good - kFront) break;
      const std::string_view digest = std::string_view(bytes).substr(good + 2 * sizeof size, kDigest);
      const std::string_view record = std::string_view(bytes).substr(good + kFront, size);
      if (hashOf(record) != digest) break;
      try {
        found.push_back(decode(record));
      } catch (const std::out_of_range&) {
        break;
      }
      good += kFront + size;
    }
  }
  fs::last_write_time(file_, fs::file_time_type::clock::now(), ec);  // what was used last goes last
  if (good < bytes.size() && found.size() < clusters && lock() && ftruncate(descriptor_, static_cast<off_t>(good)) != 0) fail(file_, "its damaged end can't be taken off");
  return found;
}

void TransportStore::append(size_t number, const ClusterTransport& c) {
  if (!lock()) return;
  const std::string record = encode(c);
  ByteWriter w;
  w.value<uint64_t>(number);
  w.value<uint64_t>(record.size());
  struct stat status {};
  if (fstat(descriptor_, &status) != 0) fail(file_, "can't be looked at");
  std::string bytes = status.st_size == 0 ? header(key_) : std::string();
  bytes += w.bytes() + hashOf(record) + record;
  for (size_t done = 0; done < bytes.size();) {
    const ssize_t n = write(descriptor_, bytes.data() + done, bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) {
      const int reason = errno;
      if (ftruncate(descriptor_, status.st_size) != 0) logWarning(file_.string() + ": ends in the middle of a cluster");
      errno = reason;
      fail(file_, "can't be written");
    }
    done += static_cast<size_t>(n);
  }
}

}  // namespace hl
