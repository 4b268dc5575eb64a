#include "ui/main_window.h"

#include <QApplication>
#include <QDialog>
#include <QDockWidget>
#include <QLabel>
#include <QMetaObject>
#include <QPointer>
#include <QProgressBar>
#include <QStatusBar>
#include <QThreadPool>
#include <QToolButton>
#include <QVBoxLayout>
#include <algorithm>

#include "engine/scene/scene_file.h"
#include "ui/error_dock.h"
#include "ui/inspector.h"
#include "ui/log_dock.h"
#include "ui/preset_actions.h"
#include "ui/probes_panel.h"
#include "ui/profiler_dock.h"
#include "ui/scene_dock.h"
#include "ui/settings.h"
#include "ui/shader_watcher.h"
#include "ui/technique_dock.h"
#include "ui/viewport.h"
#include "ui/viewport_bar.h"
#include "ui/work_line.h"

namespace hl::ui {
namespace {

constexpr int kPanelIntervalMs = 100;      // ten times a second at most
constexpr int kProgressIntervalMs = 100;
constexpr int kErrorShownMs = 12000;
constexpr float kProbeLift = 0.05f;        // of a probe over the surface that was clicked, as a share of the scene's longest side

float longestSide(const Bounds& b) {
  const vec3 side = b.empty() ? vec3(0.0f) : b.max - b.min;
  return std::max({side.x, side.y, side.z});
}

}  // namespace

MainWindow::MainWindow(EngineLink& link, Settings& settings, const QString& fileToOpen)
    : link_(link),
      settings_(settings),
      document_(link, catalog_),
      feed_(link),
      compare_(link, document_, feed_),
      palette_(&settings),
      passes_(palette_),
      bookmarks_(settings) {
  setObjectName(QStringLiteral("mainWindow"));
  setAcceptDrops(true);
  setDockOptions(AnimatedDocks | AllowNestedDocks | AllowTabbedDocks | GroupedDragging);
  auto* centre = new QWidget(this);
  auto* column = new QVBoxLayout(centre);
  column->setContentsMargins(0, 0, 0, 0);
  column->setSpacing(0);
  bar_ = new ViewportBar(document_, centre);
  viewport_ = new Viewport(centre);
  column->addWidget(bar_);
  column->addWidget(viewport_, 1);
  setCentralWidget(centre);
  files_ = new PresetActions(document_, link_, feed_, settings_, this);
  buildDocks();
  buildMenus();
  buildStatusBar();
  connectEngine();
  connectTools();
  connectProbes();
  connectSweep();
  restoreLayout();
  updateTitle();
  viewport_->setWaiting(tr("Starting the engine..."));
  viewport_->setFocus();
  watcher_ = std::make_unique<ShaderWatcher>();
  connect(watcher_.get(), &ShaderWatcher::changed, this, [this] {
    if (reloadOnChange_->isChecked()) link_.reloadShaders();
  });
  listFiles();
  document_.open(fileToOpen);
}

/// Panels and dialogs first: they still use what this window has.
MainWindow::~MainWindow() {
  for (QDialog* dialog : findChildren<QDialog*>(QString(), Qt::FindDirectChildrenOnly)) delete dialog;
  for (QDockWidget* dock : docks_) delete dock;
}

void MainWindow::buildStatusBar() {
  status_ = new QLabel(this);
  status_->setTextFormat(Qt::PlainText);
  loading_ = new QProgressBar(this);
  loading_->setFixedWidth(220);
  loading_->setMaximumHeight(fontMetrics().height() + 4);
  cancelLoading_ = new QToolButton(this);
  cancelLoading_->setText(tr("Cancel"));
  restart_ = new QToolButton(this);
  restart_->setText(tr("Start the engine again"));
  restart_->hide();
  statusBar()->addWidget(status_, 1);
  sweepStatus_ = new QToolButton(this);
  sweepStatus_->setObjectName(QStringLiteral("sweepStatus"));
  sweepStatus_->setAutoRaise(true);
  sweepStatus_->setToolTip(tr("A sweep measures: the picture rests meanwhile, and edits show between two runs"));
  sweepStatus_->hide();
  statusBar()->addPermanentWidget(restart_);
  statusBar()->addPermanentWidget(sweepStatus_);
  statusBar()->addPermanentWidget(loading_);
  statusBar()->addPermanentWidget(cancelLoading_);
  connect(cancelLoading_, &QToolButton::clicked, this, [this] { link_.cancel(); });
  connect(restart_, &QToolButton::clicked, this, &MainWindow::restartEngine);
  updateProgress();
}

void MainWindow::connectEngine() {
  connect(&link_, &EngineLink::frameReady, this, &MainWindow::onFrame);
  connect(&link_, &EngineLink::failed, this, &MainWindow::onFailed);
  connect(&link_, &EngineLink::presenterReady, this, [this](const std::shared_ptr<Presenter>& presenter) {
    presenter_ = presenter;
    choosePresenter();
  });
  connect(viewport_, &Viewport::presenterFailed, this, [this](const QString& why) {
    viewport_->usePresenter(nullptr);
    presenterText_ = tr("read-back: %1").arg(why);
    logWarning("Viewport: " + presenterText_.toStdString());
    link_.renderOnce();
  });
  connect(&link_, &EngineLink::saved, this, [this](const QString& path, const QString&) {
    statusBar()->showMessage(tr("Saved %1").arg(path), 5000);
    if (closeAfterSave_ && !document_.modified()) close();
  });
  connect(&link_, &EngineLink::shadersReloaded, this, [this](const ReloadReport& report) {
    for (const std::string& e : report.errors) logError(e);
    if (!report.errors.empty())
      showError(QString::fromStdString(report.errors.front()), true);
    else
      statusBar()->showMessage(tr("%n shaders reloaded", nullptr, static_cast<int>(report.reloaded.size())), 4000);
  });
  connect(&document_, &Document::openedFile, this, [this](const QString& path, const QStringList& warnings) {
    for (const QString& w : warnings) logWarning(w.toStdString());
    showError(warnings.join(QStringLiteral("; ")));
    if (!path.isEmpty()) statusBar()->showMessage(tr("Opened %1").arg(path), 5000);
    updateTitle();
  });
  connect(&document_, &Document::modifiedChanged, this, [this](bool modified) {
    setWindowModified(modified);
    if (closeAfterSave_ && !modified) close();
  });
  connect(&document_, &Document::presetChanged, this, &MainWindow::updateTitle);
  connect(&document_, &Document::displayChanged, this, &MainWindow::wantReferenceForView);
  connect(&document_, &Document::cameraChanged, this, [this](bool fromOutside) {
    if (fromOutside) giveViewportCamera();
  });
  connect(&compare_, &Compare::picturesChanged, this, &MainWindow::showComparison);
  connect(&compare_, &Compare::choiceChanged, this, &MainWindow::showComparison);
  connect(&compare_, &Compare::referenceNeeded, this, [this] { errors_->setReferenceWanted(true); });
  connect(&compare_, &Compare::snapshotTaken, this, [this](int id) { statusBar()->showMessage(tr("Kept as %1").arg(compare_.snapshots().find(id)->name), 4000); });
  connect(&compare_.snapshots(), &Snapshots::refused, this, [this](const QString& why) { showError(why); });
  connect(viewport_, &Viewport::wipeMoved, this, [this](double share) {
    CompareChoice c = compare_.choice();
    c.wipe = share;
    compare_.choose(c);
  });
  connect(viewport_, &Viewport::cameraMoved, &document_, &Document::moveCamera);
  connect(viewport_, &Viewport::referenceHeld, this, &MainWindow::holdReference);
  connect(viewport_, &Viewport::bookmarkWanted, this, &MainWindow::goToBookmark);
  connect(viewport_, &Viewport::bookmarkStored, this, &MainWindow::storeBookmark);
  connect(viewport_, &Viewport::pixelPicked, this, [this](int x, int y) { link_.pick(x, y); });
  connect(viewport_, &Viewport::focusWanted, this, [this](int x, int y) {
    focusPixel_ = QPoint(x, y);
    link_.pick(x, y);
  });
  connect(technique_, &TechniquePanel::message, this, [this](const QString& text) { statusBar()->showMessage(text, 8000); });
  connect(scenePanel_, &ScenePanel::bookmarkChosen, this, &MainWindow::goToBookmark);
  connect(scenePanel_, &ScenePanel::openFileWanted, files_, &PresetActions::openSceneFile);
  connect(scenePanel_, &ScenePanel::saveSceneWanted, files_, &PresetActions::saveSceneAs);

  panelTimer_.setSingleShot(true);
  panelTimer_.setInterval(kPanelIntervalMs);
  connect(&panelTimer_, &QTimer::timeout, this, &MainWindow::updatePanels);
  progressTimer_.setInterval(kProgressIntervalMs);
  connect(&progressTimer_, &QTimer::timeout, this, &MainWindow::updateProgress);
  progressTimer_.start();
  errorTimer_.setSingleShot(true);
  errorTimer_.setInterval(kErrorShownMs);
  connect(&errorTimer_, &QTimer::timeout, this, [this] { showError({}); });
}

/// Scenes and presets are looked for in the file system, so by a worker.
void MainWindow::listFiles() {
  QThreadPool::globalInstance()->start([window = QPointer<MainWindow>(this)] {
    std::vector<SceneListing> scenes;
    std::vector<PresetListing> presets;
    try {
      scenes = listScenes();
      presets = listPresets();
    } catch (const Error& e) {
      logWarning(e.what());
    }
    QMetaObject::invokeMethod(
        qApp,
        [window, scenes, presets] {
          if (!window) return;
          window->scenePanel_->setScenes(scenes);
          window->files_->setPresets(presets);
        },
        Qt::QueuedConnection);
  });
}

void MainWindow::onFrame() {
  frame_ = link_.latest();
  if (!frame_) return;
  if (presenterText_.isEmpty()) choosePresenter();
  viewport_->setWaiting({});
  viewport_->showFrame(frame_);
  profiler_->showFrame(frame_);
  // Who takes hold of the camera on its way goes on from there.
  if (!document_.preset().animation.cameraPath.empty() && frame_->scene) viewport_->setCamera(frame_->camera, frame_->scene->bounds.diagonal());
  if constexpr (requires { frame_->picked; }) {
    const auto& p = frame_->picked;
    if (focusPixel_ && p.x == focusPixel_->x() && p.y == focusPixel_->y()) {
      focusPixel_.reset();
      if (p.triangle != kNone) viewport_->focusOn(p.position);
    }
  }
  if (const auto& p = frame_->picked; probePixel_ && p.x == probePixel_->x() && p.y == probePixel_->y()) {
    probePixel_.reset();
    // In front of the surface, as far as it takes to see something of it.
    if (p.triangle != kNone && frame_->scene) probes_->add(p.position + p.normal * (kProbeLift * longestSide(frame_->scene->bounds)));
  }
  updateProbes();
  const QString message = QString::fromStdString(frame_->message);
  if (message != frameMessage_) {
    frameMessage_ = message;
    if (!message.isEmpty()) logWarning(frame_->message);
    updateNotice();
  }
  if (!panelTimer_.isActive()) panelTimer_.start();
}

void MainWindow::updatePanels() {
  if (!frame_) return;
  bar_->showFrame(*frame_);
  passes_.show(*frame_);
  technique_->showFrame(*frame_);
  scenePanel_->showFrame(*frame_);
  errors_->showFrame(frame_);
  inspector_->showFrame(frame_);
  probes_->showFrame(frame_);
  const Provenance& p = frame_->provenance;
  QString text = tr("%1   %2   %3 \u00d7 %4").arg(QString::fromStdString(p.device), QString::fromStdString(p.tracer)).arg(frame_->width).arg(frame_->height);
  text += QStringLiteral("   ") + (frame_->settled ? tr("settled") : frame_->technique.running ? tr("baking") : frame_->reference.running ? tr("tracing the reference") : tr("rendering"));
  status_->setText(text);
}

/// Loading and rebuilding run inside one edit or frame: only their Progress tells.
void MainWindow::updateProgress() {
  const auto progress = link_.progress();
  const bool running = progress && progress->total() > 0 && progress->done() < progress->total() && !progress->cancelled();
  loading_->setVisible(running);
  cancelLoading_->setVisible(running);
  if (!running) {
    loadingWhat_ = nullptr;
    if (!frame_ && document_.opening()) viewport_->setWaiting(tr("Loading..."));
    return;
  }
  if (loadingWhat_ != progress->what()) {
    loadingWhat_ = progress->what();
    loadingSince_.start();
  }
  const double share = static_cast<double>(progress->done()) / static_cast<double>(progress->total());
  const double passed = static_cast<double>(loadingSince_.elapsed()) / 1000;
  loading_->setRange(0, 1000);
  loading_->setValue(static_cast<int>(share * 1000));
  QString text = QString::fromUtf8(progress->what());
  loading_->setFormat(QStringLiteral("%1 %").arg(share * 100, 0, 'f', 0));
  if (share > 0.02 && passed > 1) text += tr(", %1 left").arg(durationText(passed / share * (1 - share)));
  status_->setText(text);
  if (!frame_) viewport_->setWaiting(QStringLiteral("%1\n%2 %").arg(text).arg(share * 100, 0, 'f', 0));
}

void MainWindow::onFailed(const QString& message, ErrorKind kind) {
  closeAfterSave_ = false;
  focusPixel_.reset();
  if (kind == ErrorKind::Cancelled) {
    logInfo(message.toStdString());
    statusBar()->showMessage(message, 5000);
    return;
  }
  logError(message.toStdString());
  if (kind == ErrorKind::Device && presenter_) {
    viewport_->usePresenter(nullptr);  // its device is gone; what is to be said is painted
    presenter_.reset();
  }
  showError(message, kind == ErrorKind::Device);
  restart_->setVisible(kind == ErrorKind::Device);
}

void MainWindow::showError(const QString& text, bool lasting) {
  error_ = text;
  updateNotice();
  errorTimer_.stop();
  if (!text.isEmpty() && !lasting) errorTimer_.start();
}

void MainWindow::updateNotice() {
  viewport_->setWaiting(error_.isEmpty() || frame_ ? QString() : tr("No picture"));
  viewport_->setNotice(error_.isEmpty() || frameMessage_.isEmpty() || error_ == frameMessage_ ? error_ + (error_.isEmpty() ? frameMessage_ : QString())
                                                                                            : error_ + '\n' + frameMessage_);
}

void MainWindow::updateTitle() {
  const QString path = document_.path();
  const QString name = path.isEmpty() ? tr("untitled (%1)").arg(QString::fromStdString(document_.preset().scene).section('/', -1)) : path.section('/', -1);
  setWindowTitle(tr("%1[*] - Halflight").arg(name));
  setWindowModified(document_.modified());
  setWindowFilePath(path);
}

void MainWindow::restartEngine() {
  restart_->hide();
  showError({});
  link_.restart();
  document_.sendAll();
  feed_.sendAll();
}

}  // namespace hl::ui
