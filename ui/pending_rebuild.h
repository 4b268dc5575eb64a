#pragma once
// Edits that would begin a rebuild, kept back until it is known what that takes: short ones go on by themselves, for others the person is asked.
#include <QObject>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "ui/engine_link.h"

namespace hl::ui {

class PendingRebuild : public QObject {
  Q_OBJECT
 public:
  /// A rebuild that takes less is not worth a question [s].
  static constexpr double kAskFrom = 1;

  PendingRebuild(EngineLink&, QObject* parent = nullptr);

  /// Keeps a parameter back: `now` is what the session has, `wanted` what it is to be. Back at what the session has, nothing waits.
  void keep(const std::string& key, const std::string& now, const std::string& wanted);
  using Probes = std::optional<std::vector<vec3>>;
  void keepProbes(const Probes& now, const Probes& wanted);
  /// After all that one edit keeps back: asks the session what it would take.
  void ask();
  /// Sends what waits.
  void make();
  /// Forgets it: the session is about to get, or to tell, all that there is.
  void drop();

  bool waits() const { return !parameters_.empty() || probes_.has_value(); }
  bool waits(const std::string& key) const { return parameters_.count(key) > 0; }
  /// What the session has, of what waits.
  std::map<std::string, std::string> parametersNow() const;
  std::map<std::string, std::string> parametersWanted() const;
  std::optional<Probes> probesNow() const;
  /// Of what waits; none while the session has not answered.
  const std::optional<RebuildForecast>& forecast() const { return forecast_; }

 signals:
  void changed();

 private:
  template <class T>
  struct Change {
    T now, wanted;
  };
  void onForecast(const RebuildForecast&, quint64 ticket);

  EngineLink& link_;
  std::map<std::string, Change<std::string>> parameters_;
  std::optional<Change<Probes>> probes_;
  std::optional<RebuildForecast> forecast_;
  quint64 ticket_ = 0;
  bool told_ = false;  ///< that something waits
};

}  // namespace hl::ui
