#include "engine/session/work_rates.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "engine/core/files.h"
#include "engine/core/log.h"

namespace hl {
namespace {

constexpr double kLeastMs = 20;        // shorter work is submission and chance
constexpr size_t kMostEntries = 512;   // the oldest go
constexpr const char* kMagic = "halflight work rates 1";

std::string cleaned(std::string text) {
  for (char& c : text)
    if (c == '|' || c == '\n' || c == '\t') c = ' ';
  return text;
}

}  // namespace

WorkRates::WorkRates(std::string machine) : file_(cacheFolder() / "work_rates.txt"), machine_(cleaned(std::move(machine))) { read(entries_); }

void WorkRates::read(std::map<std::string, Entry>& entries) const {
  std::error_code ec;
  if (!std::filesystem::is_regular_file(file_, ec)) return;
  std::string text;
  try {
    text = readFile(file_);
  } catch (const std::exception&) {
    return;  // it is a memory, nothing more
  }
  std::istringstream lines(text);
  std::string line;
  if (!std::getline(lines, line) || line != kMagic) return;
  uint64_t age = 0;
  while (std::getline(lines, line)) {
    const size_t tab = line.find('\t');
    if (tab == std::string::npos) continue;
    double value = 0;
    const auto end = std::from_chars(line.data(), line.data() + tab, value);
    if (end.ec == std::errc() && end.ptr == line.data() + tab && std::isfinite(value) && value > 0) entries[line.substr(tab + 1)] = {value, ++age};
  }
}

std::optional<WorkRates::Rate> WorkRates::of(const std::string& scene, const std::string& technique, const std::string& part) const {
  const std::string tail = fmt::format("|{}|{}", cleaned(technique), cleaned(part)), head = fmt::format("{}|", machine_);
  if (const auto found = entries_.find(fmt::format("{}{}{}", head, cleaned(scene), tail)); found != entries_.end()) return Rate{found->second.msPerAmount, true};
  const Entry* newest = nullptr;
  for (const auto& [key, entry] : entries_)
    if (key.starts_with(head) && key.ends_with(tail) && (!newest || entry.age > newest->age)) newest = &entry;
  if (!newest) return std::nullopt;
  return Rate{newest->msPerAmount, false};
}

void WorkRates::learn(const std::string& scene, const std::string& technique, const std::string& part, double amount, double ms) {
  if (!(amount > 0) || !(ms > 0)) return;
  const std::string key = fmt::format("{}|{}|{}|{}", machine_, cleaned(scene), cleaned(technique), cleaned(part));
  if (ms < kLeastMs && entries_.count(key) > 0) return;
  uint64_t age = 0;
  for (const auto& [unused, entry] : entries_) age = std::max(age, entry.age);
  entries_[key] = {ms / amount, age + 1};
  learned_.push_back(key);
}

void WorkRates::store() {
  if (learned_.empty()) return;
  // With what other programs have learned meanwhile.
  std::map<std::string, Entry> all;
  read(all);
  uint64_t age = all.size();
  for (const std::string& key : learned_) all[key] = {entries_.at(key).msPerAmount, ++age};
  learned_.clear();
  std::vector<std::pair<uint64_t, std::string>> order;
  for (const auto& [key, entry] : all) order.push_back({entry.age, key});
  std::sort(order.begin(), order.end());
  if (order.size() > kMostEntries) order.erase(order.begin(), order.end() - static_cast<std::ptrdiff_t>(kMostEntries));
  std::string text = fmt::format("{}\n", kMagic);
  for (const auto& [unused, key] : order) text += fmt::format("{}\t{}\n", all.at(key).msPerAmount, key);
  try {
    std::filesystem::create_directories(file_.parent_path());
    writeFileAtomically(file_, text);
  } catch (const std::exception& e) {
    logWarning(fmt::format("how fast work was done is not kept: {}", e.what()));
  }
}

}  // namespace hl
