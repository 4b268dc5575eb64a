#include "engine/techniques/srp/store.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "engine/core/byte_stream.h"
#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/hash.h"

namespace hl {
namespace fs = std::filesystem;
namespace {

constexpr std::string_view kMagic = "halflight transport 1\n";

std::string header(const std::string& key) { return std::string(kMagic) + key + "\n"; }

std::string encode(const ClusterTransport& c) {
  ByteWriter w;
  w.value(c.receivers), w.value(c.columns), w.value(c.rank);
  w.array(c.basis), w.array(c.weights), w.array(c.valid);
  w.value(c.total), w.value(c.discarded);
  return w.take();
}

ClusterTransport decode(std::string_view bytes) {
  ByteReader r(bytes);
  ClusterTransport c;
  c.receivers = r.value<uint32_t>(), c.columns = r.value<uint32_t>(), c.rank = r.value<uint32_t>();
  r.array(c.basis), r.array(c.weights), r.array(c.valid);
  c.total = r.value<double>(), c.discarded = r.value<double>();
  const uint64_t basis = c.basis.empty() ? 0 : uint64_t{c.rank} * c.columns;
  if (!r.atEnd() || c.basis.size() != basis || c.weights.size() != uint64_t{c.receivers} * c.rank || c.valid.size() != c.receivers)
    throw std::out_of_range("sizes");
  return c;
}

}  // namespace

TransportStore::TransportStore(const std::string& key) : file_(cacheFolder() / "transport" / (key + ".hlt")), key_(key) {}

std::vector<ClusterTransport> TransportStore::read(size_t clusters) {
  std::vector<ClusterTransport> found;
  std::error_code ec;
  if (!fs::is_regular_file(file_, ec)) return found;
  const std::string bytes = readFile(file_);
  const std::string head = header(key_);
  size_t good = 0;
  if (std::string_view(bytes).substr(0, head.size()) == head) {
    good = head.size();
    while (found.size() < clusters && bytes.size() - good >= sizeof(uint64_t)) {
      uint64_t size = 0;
      std::memcpy(&size, bytes.data() + good, sizeof size);
      constexpr size_t kDigest = 32;
      if (size > bytes.size() || bytes.size() - good - sizeof size < kDigest + size) break;
      const std::string_view digest = std::string_view(bytes).substr(good + sizeof size, kDigest);
      const std::string_view record = std::string_view(bytes).substr(good + sizeof size + kDigest, size);
      if (hashOf(record) != digest) break;
      try {
        found.push_back(decode(record));
      } catch (const std::out_of_range&) {
        break;
      }
      good += sizeof size + kDigest + size;
    }
  }
  if (good < bytes.size()) {
    if (good == 0) fs::remove(file_, ec);
    else fs::resize_file(file_, good, ec);
    if (ec) throw Error(ErrorKind::Run, file_.string() + ": its damaged end can't be taken off: " + ec.message());
  }
  return found;
}

void TransportStore::append(const ClusterTransport& c) {
  std::error_code ec;
  fs::create_directories(file_.parent_path(), ec);
  const bool fresh = !fs::is_regular_file(file_, ec);
  const std::string record = encode(c);
  ByteWriter w;
  w.value<uint64_t>(record.size());
  errno = 0;
  std::ofstream out(file_, std::ios::binary | std::ios::app);
  if (fresh) out << header(key_);
  out << w.bytes() << hashOf(record) << record;
  out.flush();
  if (!out) throw Error(ErrorKind::Run, file_.string() + ": can't be written: " + std::strerror(errno));
}

}  // namespace hl
