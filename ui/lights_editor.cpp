#include "ui/lights_editor.h"

#include <QColorDialog>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QListWidget>
#include <QMenu>
#include <QPushButton>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>
#include <cmath>

namespace hl::ui {
namespace {

constexpr double kFarthest = 1e6;       // m
constexpr double kBrightest = 1e9;
constexpr float kDegree = 57.29577951f;

float srgbFromLinear(float v) { return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1 / 2.4f) - 0.055f; }
float linearFromSrgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

float largest(vec3 v) { return std::max({v.x, v.y, v.z}); }

bool same(const LightEdits& a, const LightEdits& b) {
  const auto points = [](const PointLight& x, const PointLight& y) {
    return x.name == y.name && x.position == y.position && x.intensity == y.intensity;
  };
  const auto spots = [](const SpotLight& x, const SpotLight& y) {
    return x.name == y.name && x.position == y.position && x.direction == y.direction && x.intensity == y.intensity &&
           x.innerAngle == y.innerAngle && x.outerAngle == y.outerAngle;
  };
  const auto directionals = [](const DirectionalLight& x, const DirectionalLight& y) {
    return x.name == y.name && x.direction == y.direction && x.irradiance == y.irradiance;
  };
  return a.sky == b.sky && std::equal(a.points.begin(), a.points.end(), b.points.begin(), b.points.end(), points) &&
         std::equal(a.spots.begin(), a.spots.end(), b.spots.begin(), b.spots.end(), spots) &&
         std::equal(a.directionals.begin(), a.directionals.end(), b.directionals.begin(), b.directionals.end(), directionals);
}

QString vectorText(vec3 v) {
  return QStringLiteral("%1, %2, %3").arg(v.x, 0, 'g', 4).arg(v.y, 0, 'g', 4).arg(v.z, 0, 'g', 4);
}

QDoubleSpinBox* numberField(QWidget* parent, double low, double high, int decimals) {
  auto* f = new QDoubleSpinBox(parent);
  f->setRange(low, high);
  f->setDecimals(decimals);
  f->setKeyboardTracking(false);
  f->setLocale(QLocale::c());
  f->setButtonSymbols(QAbstractSpinBox::NoButtons);
  f->setMinimumWidth(48);
  f->setStepType(QAbstractSpinBox::AdaptiveDecimalStepType);
  f->setFocusPolicy(Qt::StrongFocus);
  return f;
}

QWidget* triple(QWidget* parent, QDoubleSpinBox* (&fields)[3], const QString& name) {
  auto* row = new QWidget(parent);
  auto* line = new QHBoxLayout(row);
  line->setContentsMargins(0, 0, 0, 0);
  line->setSpacing(3);
  const char* axes[3] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    fields[i] = numberField(row, -kFarthest, kFarthest, 3);
    fields[i]->setAccessibleName(name + ' ' + axes[i]);
    line->addWidget(fields[i], 1);
  }
  return row;
}

}  // namespace

LightsEditor::LightsEditor(Document& document, QWidget* parent)
    : QWidget(parent), document_(document), list_(new QListWidget(this)), form_(new QWidget(this)), note_(new QLabel(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  list_->setAccessibleName(tr("Lights"));
  list_->setUniformItemSizes(true);
  list_->setMaximumHeight(fontMetrics().height() * 7);
  column->addWidget(list_);

  auto* buttons = new QHBoxLayout;
  auto* addButton = new QToolButton(this);
  addButton->setText(tr("Add light"));
  addButton->setPopupMode(QToolButton::InstantPopup);
  auto* menu = new QMenu(addButton);
  menu->addAction(tr("Point light"), this, [this] { add(Kind::Point); });
  menu->addAction(tr("Spot light"), this, [this] { add(Kind::Spot); });
  menu->addAction(tr("Directional light"), this, [this] { add(Kind::Directional); });
  addButton->setMenu(menu);
  auto* removeButton = new QToolButton(this);
  removeButton->setText(tr("Remove"));
  connect(removeButton, &QToolButton::clicked, this, &LightsEditor::removeSelected);
  buttons->addWidget(addButton);
  buttons->addWidget(removeButton);
  buttons->addStretch(1);
  column->addLayout(buttons);

  rows_ = new QFormLayout(form_);
  rows_->setContentsMargins(0, 0, 0, 0);
  rows_->setFieldGrowthPolicy(QFormLayout::AllNonFixedFieldsGrow);
  positionRow_ = triple(form_, position_, tr("Position"));
  directionRow_ = triple(form_, direction_, tr("Direction"));
  intensity_ = numberField(form_, 0, kBrightest, 4);
  inner_ = numberField(form_, 0, 89, 2);
  outer_ = numberField(form_, 0.1, 90, 2);
  colour_ = new QPushButton(form_);
  colour_->setAccessibleName(tr("Colour"));
  rows_->addRow(tr("Position [m]"), positionRow_);
  rows_->addRow(tr("Direction"), directionRow_);
  rows_->addRow(tr("Colour"), colour_);
  rows_->addRow(tr("Intensity"), intensity_);
  rows_->addRow(tr("Inner half-angle [\u00b0]"), inner_);
  rows_->addRow(tr("Outer half-angle [\u00b0]"), outer_);
  column->addWidget(form_);
  note_->setWordWrap(true);
  column->addWidget(note_);

  for (QDoubleSpinBox* f : {position_[0], position_[1], position_[2], direction_[0], direction_[1], direction_[2], intensity_, inner_, outer_})
    connect(f, &QDoubleSpinBox::valueChanged, this, &LightsEditor::edit);
  connect(colour_, &QPushButton::clicked, this, &LightsEditor::chooseColour);
  connect(list_, &QListWidget::currentRowChanged, this, &LightsEditor::showSelected);
  connect(&document_, &Document::sceneChanged, this, &LightsEditor::readScene);
  connect(&document_, &Document::presetChanged, this, &LightsEditor::readLights);
  readScene();
}

void LightsEditor::readScene() {
  emitters_.clear();
  if (const auto scene = document_.scene())
    for (const Material& m : scene->materials)
      if (largest(m.emission) > 0) emitters_.push_back(m);
  readLights();
}

void LightsEditor::readLights() {
  const auto scene = document_.scene();
  const LightEdits now = document_.preset().lights ? *document_.preset().lights : scene ? lightsOf(*scene) : LightEdits{};
  // What this editor itself has just sent out is no news: refilling would take the field from under the fingers.
  size_t listed = 0;
  for (const Entry& e : entries_) listed += e.kind == Kind::Surface;
  if (!entries_.empty() && listed == emitters_.size() && same(now, lights_)) return;
  lights_ = now;
  fillList();
}

void LightsEditor::fillList() {
  filling_ = true;
  const int row = list_->currentRow();
  const size_t before = entries_.size();
  entries_.clear();
  list_->clear();
  const auto put = [&](Kind kind, size_t index, const QString& name, const QString& what) {
    entries_.push_back({kind, index});
    list_->addItem(name.isEmpty() ? what : QStringLiteral("%1 (%2)").arg(name, what));
  };
  for (size_t i = 0; i < lights_.points.size(); ++i) put(Kind::Point, i, QString::fromStdString(lights_.points[i].name), tr("point"));
  for (size_t i = 0; i < lights_.spots.size(); ++i) put(Kind::Spot, i, QString::fromStdString(lights_.spots[i].name), tr("spot"));
  for (size_t i = 0; i < lights_.directionals.size(); ++i)
    put(Kind::Directional, i, QString::fromStdString(lights_.directionals[i].name), tr("directional"));
  put(Kind::Sky, 0, {}, tr("sky"));
  for (size_t i = 0; i < emitters_.size(); ++i) put(Kind::Surface, i, QString::fromStdString(emitters_[i].name), tr("emissive surface"));
  list_->setCurrentRow(row >= 0 && before == entries_.size() ? row : 0);
  filling_ = false;
  showSelected();
}

vec3* LightsEditor::colourOf(const Entry& e) {
  switch (e.kind) {
    case Kind::Point: return &lights_.points[e.index].intensity;
    case Kind::Spot: return &lights_.spots[e.index].intensity;
    case Kind::Directional: return &lights_.directionals[e.index].irradiance;
    case Kind::Sky: return &lights_.sky;
    case Kind::Surface: return nullptr;
  }
  return nullptr;
}

void LightsEditor::showSelected() {
  const int row = list_->currentRow();
  if (filling_) return;
  const bool any = row >= 0 && static_cast<size_t>(row) < entries_.size();
  form_->setVisible(any && entries_[static_cast<size_t>(row)].kind != Kind::Surface);
  note_->setVisible(false);
  if (!any) return;
  filling_ = true;
  const Entry e = entries_[static_cast<size_t>(row)];
  const auto put = [](QDoubleSpinBox* const(&fields)[3], vec3 v) {
    for (int i = 0; i < 3; ++i) fields[i]->setValue(static_cast<double>(v[i]));
  };
  const bool placed = e.kind == Kind::Point || e.kind == Kind::Spot;
  const bool directed = e.kind == Kind::Spot || e.kind == Kind::Directional;
  const auto showRow = [&](QWidget* w, bool on) {
    w->setVisible(on);
    if (QWidget* label = rows_->labelForField(w)) label->setVisible(on);
  };
  showRow(positionRow_, placed);
  showRow(directionRow_, directed);
  showRow(inner_, e.kind == Kind::Spot);
  showRow(outer_, e.kind == Kind::Spot);
  if (e.kind == Kind::Point) put(position_, lights_.points[e.index].position);
  if (e.kind == Kind::Directional) put(direction_, lights_.directionals[e.index].direction);
  if (e.kind == Kind::Spot) {
    const SpotLight& s = lights_.spots[e.index];
    put(position_, s.position);
    put(direction_, s.direction);
    inner_->setValue(static_cast<double>(s.innerAngle * kDegree));
    outer_->setValue(static_cast<double>(s.outerAngle * kDegree));
  }
  if (const vec3* c = colourOf(e)) {
    const float strength = largest(*c);
    hue_ = strength > 0 ? *c / strength : vec3(1);
    intensity_->setValue(static_cast<double>(strength));
    intensity_->setSuffix(placed ? tr(" W/sr") : e.kind == Kind::Sky ? tr(" W/(sr m\u00b2)") : tr(" W/m\u00b2"));
    intensity_->setToolTip(tr("The largest of red, green and blue"));
    QPixmap swatch(48, 14);
    swatch.fill(QColor::fromRgbF(srgbFromLinear(hue_.x), srgbFromLinear(hue_.y), srgbFromLinear(hue_.z)));
    colour_->setIcon(QIcon(swatch));
    colour_->setIconSize(swatch.size());
    colour_->setText(vectorText(hue_));
  } else {
    const Material& m = emitters_[e.index];
    note_->setText(tr("Radiance %1 W/(sr m\u00b2), from the scene's material.").arg(vectorText(m.emission)));
    note_->setVisible(true);
  }
  filling_ = false;
}

void LightsEditor::edit() {
  const int row = list_->currentRow();
  if (filling_ || row < 0) return;
  const Entry e = entries_[static_cast<size_t>(row)];
  const auto vector = [](QDoubleSpinBox* const(&f)[3]) {
    return vec3(static_cast<float>(f[0]->value()), static_cast<float>(f[1]->value()), static_cast<float>(f[2]->value()));
  };
  const auto unit = [&](vec3 old) {
    const vec3 d = vector(direction_);
    return glm::length(d) > 0 ? glm::normalize(d) : old;
  };
  if (e.kind == Kind::Point) lights_.points[e.index].position = vector(position_);
  if (e.kind == Kind::Directional) lights_.directionals[e.index].direction = unit(lights_.directionals[e.index].direction);
  if (e.kind == Kind::Spot) {
    SpotLight& s = lights_.spots[e.index];
    s.position = vector(position_);
    s.direction = unit(s.direction);
    s.outerAngle = static_cast<float>(outer_->value()) / kDegree;
    s.innerAngle = std::min(static_cast<float>(inner_->value()) / kDegree, s.outerAngle);
  }
  if (vec3* c = colourOf(e)) *c = hue_ * static_cast<float>(intensity_->value());
  commit(tr("light %1").arg(list_->currentItem()->text()), 0);
}

void LightsEditor::chooseColour() {
  // Not modal: frames and other edits go on while a colour is chosen.
  auto* dialog = new QColorDialog(QColor::fromRgbF(srgbFromLinear(hue_.x), srgbFromLinear(hue_.y), srgbFromLinear(hue_.z)), this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setWindowTitle(tr("Colour of %1").arg(list_->currentItem()->text()));
  connect(dialog, &QColorDialog::currentColorChanged, this, [this, drag = document_.newDrag(), row = list_->currentRow()](const QColor& c) {
    if (row != list_->currentRow()) return;
    const vec3 linear(linearFromSrgb(c.redF()), linearFromSrgb(c.greenF()), linearFromSrgb(c.blueF()));
    if (!(largest(linear) > 0)) return;
    hue_ = linear / largest(linear);
    if (vec3* light = colourOf(entries_[static_cast<size_t>(row)])) *light = hue_ * static_cast<float>(intensity_->value());
    commit(tr("colour of %1").arg(list_->currentItem()->text()), drag);
  });
  dialog->open();
}

void LightsEditor::add(Kind kind) {
  const auto scene = document_.scene();
  const vec3 centre = scene && !scene->bounds.empty() ? scene->bounds.centre() : vec3(0);
  const float size = scene ? scene->bounds.diagonal() : 1;
  const vec3 strength(std::max(size * size, 1e-6f));  // W/sr that give about 4 W/m^2 half a diagonal away, whatever the scene's size
  const std::string name = tr("added %1").arg(entries_.size()).toStdString();
  if (kind == Kind::Point) lights_.points.push_back({name, centre, strength});
  if (kind == Kind::Spot) {
    SpotLight s;
    s.name = name, s.position = centre, s.intensity = strength;
    lights_.spots.push_back(s);
  }
  if (kind == Kind::Directional) {
    DirectionalLight d;
    d.name = name, d.direction = glm::normalize(vec3(-0.4f, -1, -0.3f));
    lights_.directionals.push_back(d);
  }
  fillList();
  for (size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].kind == kind) list_->setCurrentRow(static_cast<int>(i));  // the last of its kind
  commit(tr("new light"), 0);
}

void LightsEditor::removeSelected() {
  const int row = list_->currentRow();
  if (row < 0) return;
  const Entry e = entries_[static_cast<size_t>(row)];
  const auto drop = [&](auto& v) { v.erase(v.begin() + static_cast<std::ptrdiff_t>(e.index)); };
  switch (e.kind) {
    case Kind::Point: drop(lights_.points); break;
    case Kind::Spot: drop(lights_.spots); break;
    case Kind::Directional: drop(lights_.directionals); break;
    case Kind::Sky:
    case Kind::Surface: return;
  }
  fillList();
  commit(tr("removal of a light"), 0);
}

void LightsEditor::commit(const QString& what, quint64 drag) { document_.editLights(LightEdits(lights_), what, drag); }

}  // namespace hl::ui
