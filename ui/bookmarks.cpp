#include "ui/bookmarks.h"

#include <QVariantList>

#include "ui/settings.h"

namespace hl::ui {
namespace {

constexpr qsizetype kNumbers = 10;  // position, target, up, field of view

QString keyOf(const std::string& scene, int number) {
  return QStringLiteral("bookmarks/%1/%2").arg(QString::fromUtf8(QByteArray::fromStdString(scene).toPercentEncoding())).arg(number);
}

}  // namespace

std::optional<Camera> Bookmarks::stored(const std::string& scene, int number) const {
  const QVariantList v = settings_.value(keyOf(scene, number)).toList();
  if (v.size() != kNumbers) return std::nullopt;
  const auto f = [&](qsizetype i) { return v[i].toFloat(); };
  Camera c;
  c.position = vec3(f(0), f(1), f(2)), c.target = vec3(f(3), f(4), f(5)), c.up = vec3(f(6), f(7), f(8));
  c.verticalFov = f(9);
  return c;
}

void Bookmarks::store(const std::string& scene, int number, const Camera& c) {
  QVariantList v;
  for (const vec3& p : {c.position, c.target, c.up}) v << p.x << p.y << p.z;
  v << c.verticalFov;
  settings_.setValue(keyOf(scene, number), v);
}

void Bookmarks::forget(const std::string& scene, int number) { settings_.remove(keyOf(scene, number)); }

}  // namespace hl::ui
