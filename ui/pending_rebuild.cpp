#include "ui/pending_rebuild.h"

#include <utility>

namespace hl::ui {

PendingRebuild::PendingRebuild(EngineLink& link, QObject* parent) : QObject(parent), link_(link) {
  connect(&link, &EngineLink::forecastIs, this, &PendingRebuild::onForecast);
}

void PendingRebuild::keep(const std::string& key, const std::string& now, const std::string& wanted) {
  const auto [at, fresh] = parameters_.try_emplace(key, Change<std::string>{now, wanted});
  at->second.wanted = wanted;
  if (at->second.now == wanted) parameters_.erase(at);
}

void PendingRebuild::keepProbes(const Probes& now, const Probes& wanted) {
  if (!probes_) probes_ = Change<Probes>{now, wanted};
  probes_->wanted = wanted;
  if (probes_->now == wanted) probes_.reset();
}

void PendingRebuild::ask() {
  forecast_.reset();
  ++ticket_;
  if (waits()) link_.requestForecast(ticket_, parametersWanted(), probes_ ? std::optional(probes_->wanted) : std::nullopt);
  if (waits() || std::exchange(told_, false)) emit changed();
  told_ = waits();
}

void PendingRebuild::make() {
  const auto parameters = std::exchange(parameters_, {});
  const auto probes = std::exchange(probes_, std::nullopt);
  if (probes) link_.setProbes(probes->wanted);  // before the parameter that asks for them
  for (const auto& [key, change] : parameters) link_.setParam(key, change.wanted);
  drop();
}

void PendingRebuild::drop() {
  parameters_.clear();
  probes_.reset();
  forecast_.reset();
  ++ticket_;  // an answer that is on its way is of something else
  if (std::exchange(told_, false)) emit changed();
}

std::map<std::string, std::string> PendingRebuild::parametersNow() const {
  std::map<std::string, std::string> out;
  for (const auto& [key, change] : parameters_) out[key] = change.now;
  return out;
}

std::map<std::string, std::string> PendingRebuild::parametersWanted() const {
  std::map<std::string, std::string> out;
  for (const auto& [key, change] : parameters_) out[key] = change.wanted;
  return out;
}

std::optional<PendingRebuild::Probes> PendingRebuild::probesNow() const { return probes_ ? std::optional(probes_->now) : std::nullopt; }

void PendingRebuild::onForecast(const RebuildForecast& forecast, quint64 ticket) {
  if (ticket != ticket_ || !waits()) return;
  // Who cancels the answer has not said yes: it goes on waiting.
  if (!forecast.cancelled && (!forecast.rebuilds || (forecast.refused.empty() && forecast.seconds < kAskFrom))) return make();
  forecast_ = forecast;
  emit changed();
}

}  // namespace hl::ui
