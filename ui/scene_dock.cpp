#include "ui/scene_dock.h"

#include <QComboBox>
#include <QFormLayout>
#include <QGroupBox>
#include <QLabel>
#include <QListWidget>
#include <QPushButton>
#include <QScrollArea>
#include <QSignalBlocker>
#include <QSpinBox>
#include <QStandardItemModel>
#include <QVBoxLayout>
#include <limits>

#include "ui/bookmarks.h"
#include "ui/lights_editor.h"
#include "ui/time_panel.h"

namespace hl::ui {
namespace {

constexpr int kNumberRole = Qt::UserRole, kNameRole = Qt::UserRole + 1;

QLabel* textLabel(QWidget* parent) {
  auto* label = new QLabel(parent);
  label->setWordWrap(true);
  label->setTextInteractionFlags(Qt::TextSelectableByMouse | Qt::TextSelectableByKeyboard);
  label->setAlignment(Qt::AlignTop | Qt::AlignLeft);
  return label;
}

QString tableOf(const QList<std::pair<QString, QString>>& rows) {
  QString html = QStringLiteral("<table cellspacing='0' cellpadding='1'>");
  for (const auto& [name, value] : rows)
    html += QStringLiteral("<tr><td style='padding-right:10px'>%1</td><td>%2</td></tr>").arg(name, value.toHtmlEscaped());
  return html + QStringLiteral("</table>");
}

}  // namespace

ScenePanel::ScenePanel(Document& document, Bookmarks& bookmarks, QWidget* parent)
    : QWidget(parent), document_(document), bookmarks_(bookmarks), chooser_(new QComboBox(this)) {
  auto* outer = new QVBoxLayout(this);
  auto* line = new QHBoxLayout;
  chooser_->setAccessibleName(tr("Scene"));
  chooser_->setSizePolicy(QSizePolicy::Expanding, QSizePolicy::Fixed);
  chooser_->setMinimumContentsLength(12);
  chooser_->setSizeAdjustPolicy(QComboBox::AdjustToMinimumContentsLengthWithIcon);
  auto* openButton = new QPushButton(tr("Open..."), this);
  openButton->setToolTip(tr("A scene or mesh from a file"));
  line->addWidget(chooser_, 1);
  line->addWidget(openButton);
  outer->addLayout(line);

  auto* scroll = new QScrollArea(this);
  scroll->setWidgetResizable(true);
  scroll->setFrameShape(QFrame::NoFrame);
  scroll->setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
  auto* content = new QWidget(scroll);
  auto* column = new QVBoxLayout(content);
  column->setContentsMargins(0, 0, 6, 0);  // clear of the scroll bar

  auto* lights = new QGroupBox(tr("Lights"), content);
  auto* lightsColumn = new QVBoxLayout(lights);
  lightsColumn->addWidget(new LightsEditor(document, lights));
  auto* saveButton = new QPushButton(tr("Save scene as..."), lights);
  saveButton->setToolTip(tr("The scene's file with the lights and the recorded flights as they are now. A preset keeps the lights too"));
  lightsColumn->addWidget(saveButton);
  column->addWidget(lights);

  auto* cameras = new QGroupBox(tr("Cameras"), content);
  auto* camerasColumn = new QVBoxLayout(cameras);
  cameras_ = new QListWidget(cameras);
  cameras_->setAccessibleName(tr("Cameras"));
  cameras_->setMaximumHeight(fontMetrics().height() * 7);
  camerasColumn->addWidget(cameras_);
  auto* hint = new QLabel(tr("Keys 1 to 9 go to a camera, Ctrl+1 to Ctrl+9 keep the present one."), cameras);
  hint->setWordWrap(true);
  hint->setForegroundRole(QPalette::PlaceholderText);
  camerasColumn->addWidget(hint);
  column->addWidget(cameras);

  auto* time = new QGroupBox(tr("Time"), content);
  auto* timeColumn = new QVBoxLayout(time);
  time_ = new TimePanel(document, time);
  timeColumn->addWidget(time_);
  column->addWidget(time);

  auto* picture = new QGroupBox(tr("Random numbers"), content);
  auto* pictureForm = new QFormLayout(picture);
  seed_ = new QSpinBox(picture);
  seed_->setRange(0, std::numeric_limits<int>::max());
  seed_->setKeyboardTracking(false);
  seed_->setToolTip(tr("Seed of every random sequence: the same seed gives the same picture"));
  pictureForm->addRow(tr("Seed"), seed_);
  column->addWidget(picture);

  auto* facts = new QGroupBox(tr("What it has"), content);
  auto* factsColumn = new QVBoxLayout(facts);
  facts_ = textLabel(facts);
  factsColumn->addWidget(facts_);
  column->addWidget(facts);

  auto* report = new QGroupBox(tr("Import"), content);
  auto* reportColumn = new QVBoxLayout(report);
  report_ = textLabel(report);
  reportColumn->addWidget(report_);
  column->addWidget(report);
  column->addStretch(1);
  scroll->setWidget(content);
  outer->addWidget(scroll, 1);

  connect(openButton, &QPushButton::clicked, this, &ScenePanel::openFileWanted);
  connect(saveButton, &QPushButton::clicked, this, &ScenePanel::saveSceneWanted);
  connect(chooser_, &QComboBox::activated, this, [this](int i) {
    const QString id = chooser_->itemData(i).toString();
    if (!id.isEmpty() && id.toStdString() != document_.preset().scene) document_.openScene(id);
  });
  connect(cameras_, &QListWidget::itemActivated, this, [this](QListWidgetItem* item) { emit bookmarkChosen(item->data(kNumberRole).toInt()); });
  connect(cameras_, &QListWidget::itemClicked, this, [this](QListWidgetItem* item) { emit bookmarkChosen(item->data(kNumberRole).toInt()); });
  connect(seed_, &QSpinBox::valueChanged, this, [this](int v) { document_.editSeed(static_cast<uint32_t>(v)); });
  connect(&document_, &Document::sceneChanged, this, &ScenePanel::readScene);
  connect(&document_, &Document::presetChanged, this, [this] {
    readChooser();
    const QSignalBlocker block(seed_);
    seed_->setValue(static_cast<int>(document_.preset().seed));
  });
  readChooser();
}

void ScenePanel::setScenes(const std::vector<SceneListing>& scenes) {
  scenes_ = scenes;
  readChooser();
}

void ScenePanel::readChooser() {
  const QSignalBlocker block(chooser_);
  chooser_->clear();
  const QString current = QString::fromStdString(document_.preset().scene);
  auto* model = static_cast<QStandardItemModel*>(chooser_->model());
  for (const SceneListing& s : scenes_) {
    chooser_->addItem(QString::fromStdString(s.label.empty() ? s.id : s.label), QString::fromStdString(s.id));
    if (s.available) continue;
    QStandardItem* item = model->item(chooser_->count() - 1);
    item->setEnabled(false);
    item->setToolTip(QString::fromStdString(s.missing));
  }
  int at = chooser_->findData(current);
  if (at < 0) {
    chooser_->insertItem(0, current.section('/', -1), current);
    chooser_->setItemData(0, current, Qt::ToolTipRole);
    at = 0;
  }
  chooser_->setCurrentIndex(at);
}

void ScenePanel::readScene() {
  readChooser();
  readCameras();
}

void ScenePanel::readCameras() {
  cameras_->clear();
  const auto scene = document_.scene();
  if (!scene) return;
  for (int n = 1; n <= Bookmarks::kCount; ++n) {
    const bool own = bookmarks_.stored(scene->name, n).has_value();
    const size_t i = static_cast<size_t>(n - 1);
    if (!own && i >= scene->cameras.size()) continue;
    QString name = own ? tr("kept camera") : QString::fromStdString(scene->cameras[i].name);
    if (name.isEmpty()) name = tr("camera");
    auto* item = new QListWidgetItem(QStringLiteral("%1   %2").arg(n).arg(name), cameras_);
    item->setData(kNumberRole, n);
    item->setData(kNameRole, own ? QString() : name);
  }
}

void ScenePanel::showFrame(const FrameResult& f) {
  if (!f.scene) return;
  time_->showFrame(f);
  QStringList has;
  const SceneFeatures& s = f.features;
  if (s.emissive) has << tr("%1 emissive triangles").arg(s.emissiveTriangles);
  if (s.pointLights) has << tr("point lights");
  if (s.spotLights) has << tr("spot lights");
  if (s.directionalLights) has << tr("directional lights");
  if (s.sky) has << tr("sky");
  if (s.environment) has << tr("environment map");
  if (s.alphaTested) has << tr("alpha-tested surfaces");
  if (s.albedoTextures) has << tr("albedo textures");
  if (s.normalMaps) has << tr("normal maps");
  if (s.twoSided) has << tr("two-sided materials");
  if (s.glossySurfaces) has << tr("glossy surfaces");
  if (s.movingObjects) has << tr("moving objects");
  if (s.movingLights) has << tr("moving lights");
  const auto count = [](uint64_t v) { return QLocale().toString(static_cast<qulonglong>(v)); };
  QList<std::pair<QString, QString>> rows{{tr("Triangles"), count(f.triangles)},
                                          {tr("Materials"), count(f.scene->materials.size())},
                                          {tr("Objects"), count(f.scene->objects.size())},
                                          {tr("Diagonal"), tr("%1 m").arg(static_cast<double>(f.scene->bounds.diagonal()), 0, 'g', 4)},
                                          {tr("Features"), has.isEmpty() ? tr("none") : has.join(QStringLiteral(", "))}};
  if (f.atlas.coveredTexels) {
    rows << std::pair{tr("Lightmap"), f.atlas.ownCharts ? tr("%1 charts made here").arg(f.atlas.charts) : tr("the mesh's own UV set")};
    rows << std::pair{tr("Valid texels"), tr("%1 (%2 % covered)").arg(count(f.atlas.validTexels)).arg(f.atlas.coverage * 100, 0, 'f', 1)};
    rows << std::pair{tr("Inside geometry"), count(f.atlas.insideTexels)};
    rows << std::pair{tr("Overlapping"), count(f.atlas.overlappingTexels)};
    rows << std::pair{tr("Texel density"), tr("%1 per m, spread %2 %").arg(f.atlas.densityMean, 0, 'g', 3).arg(f.atlas.densitySpread * 100, 0, 'f', 0)};
  }
  const QString factsText = tableOf(rows);
  if (factsText != factsText_) facts_->setText(factsText_ = factsText);

  const ImportReport& r = f.scene->report;
  QList<std::pair<QString, QString>> import;
  if (!f.scene->source.empty()) import << std::pair{tr("File"), QString::fromStdString(f.scene->source.filename().string())};
  import << std::pair{tr("Degenerate triangles"), tr("%1 dropped").arg(count(r.degenerateTriangles))};
  import << std::pair{tr("Albedo capped"), tr("%1 materials").arg(count(r.cappedAlbedo))};
  if (r.cappedSpecular > 0) import << std::pair{tr("Specular capped"), tr("%1 materials").arg(count(r.cappedSpecular))};
  import << std::pair{tr("Missing textures"), count(r.missingTextures)};
  if (glm::length(r.recentred) > 0)
    import << std::pair{tr("Moved by"), QStringLiteral("%1, %2, %3 m").arg(static_cast<double>(-r.recentred.x)).arg(static_cast<double>(-r.recentred.y)).arg(static_cast<double>(-r.recentred.z))};
  QString reportText = tableOf(import);
  for (const std::string& w : r.warnings) reportText += QStringLiteral("<p>%1</p>").arg(QString::fromStdString(w).toHtmlEscaped());
  if (reportText != reportText_) {
    report_->setText(reportText_ = reportText);
    report_->setToolTip(QString::fromStdString(f.scene->source.string()));
  }
}

}  // namespace hl::ui
