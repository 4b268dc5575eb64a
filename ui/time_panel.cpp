#include "ui/time_panel.h"

#include <QComboBox>
#include <QDoubleSpinBox>
#include <QFormLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QSignalBlocker>
#include <QSlider>
#include <QToolButton>
#include <algorithm>
#include <cmath>

#include "engine/scene/animation.h"

namespace hl::ui {
namespace {

constexpr int kSliderSteps = 1000;
constexpr float kKeyEvery = 0.25f;       // s of a recorded flight; the cubic between keys smooths what a hand does in less
constexpr float kKeysApart = 2;          // s between keys that are set one by one
constexpr float kNearestKeys = 1e-3f;    // s

}  // namespace

float longestAnimation(const Scene& scene) {
  float longest = 1;
  const auto runs = [&](const auto& a) { longest = std::max(longest, a.keys.back().time * (a.repeat == Repeat::PingPong ? 2.0f : 1.0f)); };
  for (const ObjectAnimation& a : scene.animations) runs(a);
  for (const LightAnimation& a : scene.lightAnimations) runs(a);
  for (const CameraPath& p : scene.cameraPaths) runs(p);
  return longest;
}

TimePanel::TimePanel(Document& document, QWidget* parent)
    : QWidget(parent),
      document_(document),
      play_(new QToolButton(this)),
      slider_(new QSlider(Qt::Horizontal, this)),
      time_(new QDoubleSpinBox(this)),
      rate_(new QDoubleSpinBox(this)),
      path_(new QComboBox(this)),
      record_(new QPushButton(tr("Record flight"), this)),
      key_(new QPushButton(tr("Add key"), this)),
      keep_(new QPushButton(tr("Keep flight"), this)),
      recorded_(new QLabel(this)) {
  auto* column = new QVBoxLayout(this);
  column->setContentsMargins(0, 0, 0, 0);
  auto* line = new QHBoxLayout;
  play_->setText(tr("Play"));
  play_->setCheckable(true);
  play_->setToolTip(tr("Lets the scene's time run: each frame is 1 / rate seconds after the one before, however long it takes to draw"));
  slider_->setRange(0, kSliderSteps);
  slider_->setAccessibleName(tr("Time"));
  time_->setRange(0, static_cast<double>(kLongestAnimation));
  time_->setDecimals(2);
  time_->setSingleStep(0.1);
  time_->setSuffix(tr(" s"));
  time_->setKeyboardTracking(false);
  time_->setAccessibleName(tr("Time in seconds"));
  line->addWidget(play_);
  line->addWidget(slider_, 1);
  line->addWidget(time_);
  column->addLayout(line);
  auto* form = new QFormLayout;
  rate_->setRange(0.1, 1000);
  rate_->setDecimals(1);
  rate_->setSuffix(tr(" frames/s"));
  rate_->setKeyboardTracking(false);
  rate_->setToolTip(tr("Frames a second of the scene's time"));
  form->addRow(tr("Rate"), rate_);
  path_->setToolTip(tr("A recorded flight that holds the camera; moving the camera leaves it"));
  form->addRow(tr("Camera path"), path_);
  column->addLayout(form);
  auto* buttons = new QHBoxLayout;
  record_->setCheckable(true);
  record_->setToolTip(tr("Notes the camera as you fly, four times a second, until pressed again"));
  key_->setToolTip(tr("Adds the present camera, two seconds after the last key"));
  keep_->setToolTip(tr("Makes the keys a path of the scene. 'Save scene as' writes it into the scene's file"));
  buttons->addWidget(record_);
  buttons->addWidget(key_);
  buttons->addWidget(keep_);
  column->addLayout(buttons);
  recorded_->setWordWrap(true);
  column->addWidget(recorded_);

  connect(play_, &QToolButton::clicked, this, [this](bool on) {
    Playback p = document_.preset().animation;
    p.play = on;
    p.start = static_cast<float>(shown_);  // from where it is; standing still keeps the moment
    send(p);
  });
  const auto go = [this](double seconds) {
    Playback p = document_.preset().animation;
    p.start = static_cast<float>(seconds);
    send(p);
  };
  connect(time_, &QDoubleSpinBox::valueChanged, this, go);
  connect(slider_, &QSlider::valueChanged, this, [this, go](int v) {
    const auto scene = document_.scene();
    if (scene) go(static_cast<double>(longestAnimation(*scene)) * v / kSliderSteps);
  });
  connect(rate_, &QDoubleSpinBox::valueChanged, this, [this](double v) {
    Playback p = document_.preset().animation;
    p.rate = static_cast<float>(v), p.start = static_cast<float>(shown_);
    send(p);
  });
  connect(path_, &QComboBox::activated, this, [this] {
    Playback p = document_.preset().animation;
    p.cameraPath = path_->currentData().toString().toStdString(), p.start = static_cast<float>(shown_);
    send(p);
  });
  connect(record_, &QPushButton::toggled, this, [this](bool on) {
    if (on) recording_ = {}, recordingSince_.start();
    record_->setText(on ? tr("Stop recording") : tr("Record flight"));
    if (const auto camera = document_.camera(); on && camera) addKey(0, *camera);
    showRecording();
  });
  connect(key_, &QPushButton::clicked, this, [this] {
    if (const auto camera = document_.camera()) addKey(recording_.keys.empty() ? 0 : recording_.keys.back().time + kKeysApart, *camera);
  });
  connect(keep_, &QPushButton::clicked, this, [this] {
    const auto scene = document_.scene();
    if (!scene || recording_.keys.size() < 2) return;
    record_->setChecked(false);
    std::vector<CameraPath> paths = scene->cameraPaths;
    const auto taken = [&](const std::string& name) { return std::any_of(paths.begin(), paths.end(), [&](const CameraPath& p) { return p.name == name; }); };
    int number = 1;
    while (taken("flight " + std::to_string(number))) ++number;
    recording_.name = "flight " + std::to_string(number);
    paths.push_back(std::exchange(recording_, {}));
    document_.keepCameraPaths(paths);
    showRecording();
  });
  connect(&document_, &Document::cameraChanged, this, [this] {
    const auto camera = document_.camera();
    if (!record_->isChecked() || !camera) return;
    const float now = static_cast<float>(recordingSince_.elapsed()) / 1000;
    if (recording_.keys.empty() || now >= recording_.keys.back().time + kKeyEvery) addKey(now, *camera);
  });
  connect(&document_, &Document::sceneChanged, this, &TimePanel::readScene);
  connect(&document_, &Document::presetChanged, this, &TimePanel::readDocument);
  readScene();
  showRecording();
}

void TimePanel::send(const Playback& p) {
  shown_ = static_cast<double>(p.start);
  document_.setPlayback(p);
}

void TimePanel::addKey(float time, const Camera& camera) {
  if (recording_.keys.empty()) time = 0;
  if (!recording_.keys.empty() && !(time > recording_.keys.back().time + kNearestKeys)) return;
  recording_.keys.push_back({time, camera});
  showRecording();
}

void TimePanel::showRecording() {
  const size_t n = recording_.keys.size();
  recorded_->setText(n == 0 ? QString() : tr("%1 keys, %2 s").arg(n).arg(static_cast<double>(recording_.keys.back().time), 0, 'f', 2));
  recorded_->setVisible(n > 0);
  keep_->setEnabled(n >= 2);
}

void TimePanel::readScene() {
  const auto scene = document_.scene();
  const bool moves = scene && animated(*scene), paths = scene && !scene->cameraPaths.empty();
  for (QWidget* w : {static_cast<QWidget*>(play_), static_cast<QWidget*>(slider_), static_cast<QWidget*>(time_), static_cast<QWidget*>(rate_)})
    w->setEnabled(moves || paths);
  const QSignalBlocker block(path_);
  path_->clear();
  path_->addItem(tr("none: the camera stays"), QString());
  if (scene)
    for (const CameraPath& p : scene->cameraPaths) path_->addItem(QString::fromStdString(p.name), QString::fromStdString(p.name));
  path_->setEnabled(paths);
  readDocument();
}

void TimePanel::readDocument() {
  const Playback& p = document_.preset().animation;
  const QSignalBlocker a(rate_), b(path_), c(play_);
  rate_->setValue(static_cast<double>(p.rate));
  path_->setCurrentIndex(std::max(0, path_->findData(QString::fromStdString(p.cameraPath))));
  play_->setChecked(p.play);
  play_->setText(p.play ? tr("Pause") : tr("Play"));
}

void TimePanel::showFrame(const FrameResult& f) {
  playing_ = f.playing;
  const auto scene = document_.scene();
  if (!scene || (time_->hasFocus() && !playing_) || slider_->isSliderDown()) return;
  shown_ = f.time;
  const QSignalBlocker a(time_), b(slider_);
  time_->setValue(f.time);
  // What still plays beyond its length repeats: the slider goes round with it.
  const double length = static_cast<double>(longestAnimation(*scene)), at = playing_ ? std::fmod(f.time, length) : std::min(f.time, length);
  slider_->setValue(static_cast<int>(std::lround(at / length * kSliderSteps)));
}

}  // namespace hl::ui
