#pragma once
// How fast kinds of work were done, by device, tracer, scene and technique. Kept in the cache folder, so that the next program knows as well; safe to delete.
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace hl {

class WorkRates {
 public:
  /// `machine`: device, driver and tracer. Reads what the cache folder has; lines that make no sense are left out.
  explicit WorkRates(std::string machine);

  struct Rate {
    double msPerAmount = 0;
    bool sameScene = true;
  };
  /// Of this scene, else of the one that was learned last.
  std::optional<Rate> of(const std::string& scene, const std::string& technique, const std::string& part) const;
  /// `ms` that `amount` took. What is too short to say much replaces nothing.
  void learn(const std::string& scene, const std::string& technique, const std::string& part, double amount, double ms);
  /// Writes what was learned since; a folder that can't be written is a warning and no more.
  void store();

 private:
  struct Entry {
    double msPerAmount = 0;
    uint64_t age = 0;  ///< rising: what was learned last has the largest
  };
  void read(std::map<std::string, Entry>&) const;

  std::filesystem::path file_;
  std::string machine_;
  std::map<std::string, Entry> entries_;  ///< "machine|scene|technique|part"
  std::vector<std::string> learned_;
};

}  // namespace hl
