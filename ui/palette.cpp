#include "ui/palette.h"

#include <QVariantMap>
#include <array>

#include "ui/settings.h"

namespace hl::ui {
namespace {

// First the hues of Okabe and Ito's palette, which stay apart under the common colour deficiencies (black is the text's); then colours of Tol's
// muted and light sets that lie between them, told apart by lightness too.
constexpr int kStrong = 7;
constexpr std::array<QRgb, 18> kColours{0xff0072b2, 0xffe69f00, 0xff009e73, 0xffd55e00, 0xff56b4e9, 0xffcc79a7, 0xfff0e442, 0xff332288, 0xff999933,
                                        0xff882255, 0xff88ccee, 0xff117733, 0xffddcc77, 0xffaa4499, 0xff8c564b, 0xff999999, 0xffffaabb, 0xff44aa99};

uint32_t fnv1a(const std::string& s) {  // fixed: std::hash may differ from one build to another
  uint32_t h = 2166136261u;
  for (const char c : s) h = (h ^ static_cast<unsigned char>(c)) * 16777619u;
  return h;
}

}  // namespace

int PassPalette::size() { return static_cast<int>(kColours.size()); }

QColor PassPalette::colour(int slot) { return QColor::fromRgb(kColours[static_cast<size_t>(slot) % kColours.size()]); }

PassPalette::PassPalette(Settings* settings, QString key) : settings_(settings), key_(std::move(key)), users_(static_cast<size_t>(size()), 0) {
  if (!settings_) return;
  const QVariantMap stored = settings_->value(key_).toMap();
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
  // The name's own place among the strong colours, then the other strong ones, then the rest: the first that fewest passes use.
  const int first = static_cast<int>(fnv1a(pass) % static_cast<uint32_t>(kStrong));
  int best = first;
  for (int turn = 0; turn < size(); ++turn) {
    const int slot = turn < kStrong ? (first + turn) % kStrong : turn;
    if (users_[static_cast<size_t>(slot)] < users_[static_cast<size_t>(best)]) best = slot;
  }
  slots_[pass] = best;
  ++users_[static_cast<size_t>(best)];
  if (settings_) {
    QVariantMap stored;
    for (const auto& [name, slot] : slots_) stored[QString::fromStdString(name)] = slot;
    settings_->setValue(key_, stored);
  }
  return colour(best);
}

}  // namespace hl::ui
