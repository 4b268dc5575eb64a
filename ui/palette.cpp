#include "ui/palette.h"

#include <QVariantMap>
#include <algorithm>
#include <array>

#include "ui/settings.h"

namespace hl::ui {
namespace {

// Hues of Okabe and Ito's palette, which stay apart under the common colour deficiencies; black is left out, because it is the text's.
constexpr std::array<QRgb, 7> kHues{0xff0072b2, 0xffe69f00, 0xff009e73, 0xffd55e00, 0xff56b4e9, 0xffcc79a7, 0xfff0e442};
// Two more turns through the hues, told apart by lightness.
constexpr std::array<int, 3> kLightness{100, 145, 65};  // per cent of the hue's own

uint32_t fnv1a(const std::string& s) {  // fixed: std::hash may differ from one build to another
  uint32_t h = 2166136261u;
  for (const char c : s) h = (h ^ static_cast<unsigned char>(c)) * 16777619u;
  return h;
}

const QString kKey = QStringLiteral("passColours");

}  // namespace

int PassPalette::size() { return static_cast<int>(kHues.size() * kLightness.size()); }

QColor PassPalette::colour(int slot) {
  const int hues = static_cast<int>(kHues.size());
  const QColor base = QColor::fromRgb(kHues[static_cast<size_t>(slot % hues)]);
  const int lightness = kLightness[static_cast<size_t>(slot / hues) % kLightness.size()];
  const QColor hsl = base.toHsl();
  return QColor::fromHsl(hsl.hslHue(), hsl.hslSaturation(), std::min(225, hsl.lightness() * lightness / 100)).toRgb();
}

PassPalette::PassPalette(Settings* settings) : settings_(settings), users_(static_cast<size_t>(size()), 0) {
  if (!settings_) return;
  const QVariantMap stored = settings_->value(kKey).toMap();
  for (auto it = stored.begin(); it != stored.end(); ++it) {
    const int slot = it.value().toInt();
    if (slot < 0 || slot >= size()) continue;
    slots_[it.key().toStdString()] = slot;
    ++users_[static_cast<size_t>(slot)];
  }
}

QColor PassPalette::of(const std::string& pass) {
  const auto found = slots_.find(pass);
  if (found != slots_.end()) return colour(found->second);
  // The name's own place among the strong colours, or the next that fewest passes use.
  const int count = size();
  const int hues = static_cast<int>(kHues.size());
  const int first = static_cast<int>(fnv1a(pass) % static_cast<uint32_t>(hues));
  int best = first;
  for (int turn = 0; turn < count; ++turn) {
    const int slot = turn / hues * hues + (first + turn) % hues;
    if (users_[static_cast<size_t>(slot)] < users_[static_cast<size_t>(best)]) best = slot;
    if (users_[static_cast<size_t>(best)] == 0) break;
  }
  slots_[pass] = best;
  ++users_[static_cast<size_t>(best)];
  if (settings_) {
    QVariantMap stored;
    for (const auto& [name, slot] : slots_) stored[QString::fromStdString(name)] = slot;
    settings_->setValue(kKey, stored);
  }
  return colour(best);
}

}  // namespace hl::ui
