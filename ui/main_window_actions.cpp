// The window's menus, keys and what they do.
#include <QAction>
#include <QActionGroup>
#include <QCloseEvent>
#include <QDockWidget>
#include <QDragEnterEvent>
#include <QGuiApplication>
#include <QMenuBar>
#include <QMessageBox>
#include <QMimeData>
#include <QPushButton>
#include <QStatusBar>
#include <QToolButton>
#include <algorithm>
#include <tuple>

#include "engine/core/log.h"
#include "engine/session/probe_views.h"
#include "ui/error_dock.h"
#include "ui/figure_dialog.h"
#include "ui/inspector.h"
#include "ui/main_window.h"
#include "ui/parameter_panel.h"
#include "ui/preset_actions.h"
#include "ui/probe_tool.h"
#include "ui/probes_panel.h"
#include "ui/regions_editor.h"
#include "ui/scene_dock.h"
#include "ui/settings.h"
#include "ui/shortcuts_dialog.h"
#include "ui/sweep_dock.h"
#include "ui/technique_dock.h"
#include "ui/viewport.h"
#include "ui/viewport_bar.h"

namespace hl::ui {
namespace {

constexpr double kHalfStop = 0.5;
constexpr double kExposureLimit = 20;
const QString kPresenterKey = QStringLiteral("viewport/presenter");

}  // namespace

void MainWindow::buildMenus() {
  QMenu* file = menuBar()->addMenu(tr("&File"));
  files_->fill(*file);
  file->addAction(tr("Export &figure..."), QKeySequence(Qt::CTRL | Qt::Key_E), this, [this] {
    auto* dialog = new FigureDialog(compare_, document_, feed_, this);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->open();
  });
  file->addSeparator();
  file->addAction(tr("&Quit"), QKeySequence::Quit, this, &QWidget::close);

  QMenu* edit = menuBar()->addMenu(tr("&Edit"));
  QAction* undo = document_.undoStack().createUndoAction(this, tr("&Undo"));
  undo->setShortcut(QKeySequence::Undo);
  QAction* redo = document_.undoStack().createRedoAction(this, tr("&Redo"));
  redo->setShortcuts({QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_Z), QKeySequence(Qt::CTRL | Qt::Key_Y)});
  edit->addActions({undo, redo});

  QMenu* view = menuBar()->addMenu(tr("&View"));
  view->addAction(tr("Brighter by half a stop"), QKeySequence(Qt::Key_E), this, [this] { stepExposure(kHalfStop); });
  view->addAction(tr("Darker by half a stop"), QKeySequence(Qt::SHIFT | Qt::Key_E), this, [this] { stepExposure(-kHalfStop); });
  view->addAction(tr("Show NaN, Inf and negative pixels"), QKeySequence(Qt::Key_N), this, [this] {
    Display d = document_.preset().display;
    d.showInvalid = !d.showInvalid;
    document_.editDisplay(d, tr("invalid pixels"));
  });
  view->addAction(tr("Back to the viewport"), QKeySequence(Qt::Key_Escape), viewport_, [this] {
    regionTool_->setChecked(false);
    probeTool_->setChecked(false);
    viewport_->hidePick();
    viewport_->setFocus();
  });
  regionTool_ = view->addAction(tr("Draw regions"), QKeySequence(Qt::Key_R), this, [] {});
  regionTool_->setCheckable(true);
  showRegions_ = view->addAction(tr("Show regions"), QKeySequence(Qt::SHIFT | Qt::Key_R), this, [] {});
  showRegions_->setCheckable(true);
  connect(regionTool_, &QAction::toggled, this, [this](bool on) {
    viewport_->setRegionTool(on);
    if (on) showRegions_->setChecked(true);
  });
  connect(showRegions_, &QAction::toggled, this, &MainWindow::updateRegions);
  bar_->addTool(regionTool_);
  probeTool_ = view->addAction(tr("Edit probes by hand"), QKeySequence(Qt::Key_H), this, [] {});
  probeTool_->setCheckable(true);
  view->addAction(tr("Enlarge the picture"), QKeySequence(Qt::CTRL | Qt::Key_Plus), viewport_, &Viewport::zoomIn);
  view->addAction(tr("Make the picture smaller"), QKeySequence(Qt::CTRL | Qt::Key_Minus), viewport_, &Viewport::zoomOut);
  view->addAction(tr("Whole picture"), QKeySequence(Qt::CTRL | Qt::Key_0), viewport_, &Viewport::zoomToFit);
  view->addSeparator();
  for (QDockWidget* dock : docks_) view->addAction(dock->toggleViewAction());
  QMenu* layouts = view->addMenu(tr("&Layout"));
  auto* layoutGroup = new QActionGroup(this);
  const std::tuple<QString, QString, int> named[] = {{QStringLiteral("tune"), tr("&Tune"), Qt::Key_1}, {QStringLiteral("compare"), tr("&Compare"), Qt::Key_2}, {QStringLiteral("profile"), tr("&Profile"), Qt::Key_3}};
  for (const auto& [id, name, key] : named) {
    QAction* action = layouts->addAction(name, QKeySequence(Qt::ALT | key), this, [this, id = id] { switchLayout(id); });
    action->setCheckable(true);
    layoutGroup->addAction(action);
    layoutActions_.emplace_back(id, action);
  }
  layouts->addSeparator();
  layouts->addAction(tr("&Reset layout"), this, &MainWindow::resetLayout);
  buildPresenterMenu(*view);
  view->addAction(tr("&Full screen"), QKeySequence(Qt::Key_F11), this, [this] { setWindowState(windowState() ^ Qt::WindowFullScreen); });

  buildCompareMenu();

  QMenu* run = menuBar()->addMenu(tr("&Run"));
  pause_ = run->addAction(tr("&Pause"), QKeySequence(Qt::Key_P), this, [this] { setPaused(pause_->isChecked()); });
  pause_->setCheckable(true);
  run->addAction(tr("Start the technique &again"), QKeySequence(Qt::CTRL | Qt::Key_R), this, [this] { link_.resetTechnique(); });
  run->addAction(tr("&Cancel bake or reference"), QKeySequence(Qt::CTRL | Qt::Key_Period), this, [this] { link_.cancelWork(); });
  run->addAction(tr("Re&sume what was cancelled"), this, [this] { link_.restartWork(); });
  run->addSeparator();
  run->addAction(tr("Reload &shaders"), QKeySequence(Qt::Key_F5), this, [this] { link_.reloadShaders(); });
  reloadOnChange_ = run->addAction(tr("Reload shaders when their files change"));
  reloadOnChange_->setCheckable(true);
  reloadOnChange_->setChecked(true);

  QMenu* help = menuBar()->addMenu(tr("&Help"));
  help->addAction(tr("&Keyboard and mouse"), QKeySequence(Qt::Key_Question), this, &MainWindow::showShortcuts);
  help->addAction(tr("&About"), this, [this] {
    auto* box = new QMessageBox(QMessageBox::NoIcon, tr("About Halflight"),
                                tr("<p><b>Halflight</b>: a workbench for research on real-time global illumination.</p>"
                                   "<p>GPL-3.0-or-later. Made with Qt %1 and QCustomPlot.</p><p>%2</p><p>Viewport: %3</p>")
                                    .arg(QString::fromLatin1(qVersion()), frame_ ? QString::fromStdString(frame_->provenance.commit) : QString(), presenterText_.toHtmlEscaped()),
                                QMessageBox::Close, this);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->open();
  });
}

void MainWindow::buildPresenterMenu(QMenu& view) {
  QMenu* menu = view.addMenu(tr("Picture to the &screen"));
  presenterActions_ = new QActionGroup(this);
  presenterWish_ = parsePresenterWish(settings_.value(kPresenterKey).toString()).value_or(PresenterWish::Auto);
  const std::pair<QString, PresenterWish> wishes[] = {{tr("As the device is best at"), PresenterWish::Auto}, {tr("Drawn by the device (swapchain)"), PresenterWish::Swapchain}, {tr("Read back and painted"), PresenterWish::ReadBack}};
  for (const auto& [name, wish] : wishes) {
    QAction* action = menu->addAction(name, this, [this, wish = wish] {
      settings_.setValue(kPresenterKey, presenterWishId(wish));
      setPresenterWish(wish);
    });
    action->setCheckable(true);
    action->setChecked(wish == presenterWish_);
    action->setData(static_cast<int>(wish));
    presenterActions_->addAction(action);
  }
}

void MainWindow::setPresenterWish(PresenterWish wish) {
  presenterWish_ = wish;
  for (QAction* action : presenterActions_->actions()) action->setChecked(action->data().toInt() == static_cast<int>(wish));
  choosePresenter();
}

void MainWindow::choosePresenter() {
  if (!presenter_ && !frame_) return;  // the engine has yet to say what it has
  const PresenterChoice choice = ui::choosePresenter(presenterWish_, QGuiApplication::platformName(), presenter_.get());
  if (choice.why == presenterText_ && choice.swapchain == (viewport_->swapchainView() != nullptr)) return;
  viewport_->usePresenter(choice.swapchain ? presenter_ : nullptr);
  presenterText_ = choice.why;
  logInfo("Viewport: " + presenterText_.toStdString());
  link_.renderOnce();
}

void MainWindow::buildCompareMenu() {
  QMenu* menu = menuBar()->addMenu(tr("&Compare"));
  menu->addAction(tr("&Take a snapshot"), QKeySequence(Qt::Key_C), &compare_, &Compare::takeSnapshot);
  menu->addSeparator();
  auto* group = new QActionGroup(this);
  const std::tuple<QString, CompareMode, int> modes[] = {{tr("&Off"), CompareMode::Off, Qt::Key_F2},
                                                         {tr("Wipe, &left and right"), CompareMode::WipeAcross, Qt::Key_F3},
                                                         {tr("Wipe, &above and below"), CompareMode::WipeDown, Qt::Key_F4},
                                                         {tr("&Flicker"), CompareMode::Flicker, Qt::Key_F6},
                                                         {tr("&Side by side"), CompareMode::SideBySide, Qt::Key_F7},
                                                         {tr("&Difference"), CompareMode::Difference, Qt::Key_F8},
                                                         {tr("&Error map"), CompareMode::ErrorMap, Qt::Key_F9}};
  for (const auto& [name, mode, key] : modes) {
    QAction* action = menu->addAction(name, QKeySequence(key), this, [this, mode = mode] {
      CompareChoice c = compare_.choice();
      c.mode = mode;
      compare_.choose(c);
      if (auto* dock = findChild<QDockWidget*>(QStringLiteral("compareDock")); mode != CompareMode::Off && !dock->isHidden()) dock->raise();
    });
    action->setCheckable(true);
    action->setChecked(mode == CompareMode::Off);
    group->addAction(action);
    connect(&compare_, &Compare::choiceChanged, action, [this, action, mode = mode] { action->setChecked(compare_.choice().mode == mode); });
  }
  menu->addSeparator();
  menu->addAction(tr("S&wap A and B"), QKeySequence(Qt::Key_X), &compare_, &Compare::swap);
}

/// Inspector and regions: what the viewport's gestures mean to the docks, and back.
void MainWindow::connectTools() {
  connect(viewport_, &Viewport::inspectWanted, this, [this](int x, int y) {
    auto* dock = findChild<QDockWidget*>(QStringLiteral("inspectorDock"));
    dock->show();
    dock->raise();
    inspector_->inspect(x, y);
  });
  connect(inspector_, &InspectorPanel::pixelChanged, viewport_, [this](int x, int y) { viewport_->setMarkedPixel(QPoint(x, y)); });
  connect(inspector_, &InspectorPanel::referenceNeeded, this, [this] { errors_->setReferenceWanted(true); });
  connect(viewport_, &Viewport::regionDrawn, this, [this](const QRectF& shares) {
    showRegions_->setChecked(true);
    regions_->add(shares);
    statusBar()->showMessage(tr("Its errors are in the Error dock"), 4000);
  });
  connect(regions_, &RegionsEditor::drawWanted, regionTool_, [this] { regionTool_->setChecked(true); });
  connect(regions_, &RegionsEditor::shown, showRegions_, &QAction::setChecked);
  connect(&document_, &Document::regionsChanged, this, &MainWindow::updateRegions);
}

/// The probe tool: gestures of the viewport, the list in the dock, and the document between them.
void MainWindow::connectProbes() {
  ProbeTool& tool = viewport_->probeTool();
  connect(probeTool_, &QAction::toggled, this, [this, &tool](bool on) {
    probePixel_.reset();
    if (on) {
      regionTool_->setChecked(false);
      probes_->takeOver();
      showDock(QStringLiteral("probesDock"));
      viewport_->setFocus();
    }
    tool.setActive(on);
    probes_->setEditing(on);
    updateProbes();
  });
  connect(regionTool_, &QAction::toggled, this, [this](bool on) {
    if (on) probeTool_->setChecked(false);
  });
  connect(probes_, &ProbesPanel::editWanted, probeTool_, &QAction::setChecked);
  connect(probes_, &ProbesPanel::selected, &tool, &ProbeTool::select);
  connect(&tool, &ProbeTool::selectionChanged, this, [this, &tool] { probes_->select(tool.selected()); });
  connect(&tool, &ProbeTool::moved, probes_, &ProbesPanel::move);
  connect(viewport_, &Viewport::probeWanted, this, [this](int x, int y) {
    probePixel_ = QPoint(x, y);
    link_.pick(x, y);
  });
  connect(viewport_, &Viewport::probeDeletionWanted, this, [this, &tool] {
    if (tool.selected()) probes_->remove(*tool.selected());
  });
  connect(&document_, &Document::probesChanged, this, &MainWindow::updateProbes);
}

void MainWindow::updateProbes() {
  const std::vector<vec3> probes = probes_->probes();
  const bool known = frame_ && frame_->probes && frame_->probes->positions == probes;
  const auto scene = document_.scene();
  viewport_->probeTool().setProbes(probes, known ? frame_->probes->inside : std::vector<uint8_t>(), scene ? probeMarkRadius(scene->bounds) : 0.0f);
}

void MainWindow::showDock(const QString& name) {
  auto* dock = findChild<QDockWidget*>(name);
  dock->show();
  dock->raise();
}

void MainWindow::connectSweep() {
  connect(&technique_->parameters(), &ParameterPanel::sweepWanted, this, [this](const std::string& key) {
    showDock(QStringLiteral("sweepDock"));
    sweep_->sweepParameter(key);
  });
  connect(files_, &PresetActions::experimentOpened, this, [this](const QString& path) {
    showDock(QStringLiteral("sweepDock"));
    sweep_->openExperiment(path);
  });
  connect(files_, &PresetActions::resultsOpened, this, [this](const QString& folder) {
    showDock(QStringLiteral("sweepDock"));
    sweep_->openResults(folder);
  });
  connect(sweep_, &SweepPanel::presetChosen, this, [this](const Preset& preset, const QString& label) {
    document_.restore(preset, tr("configuration %1").arg(label));
    statusBar()->showMessage(tr("Loaded %1; undo brings back what was there").arg(label), 5000);
  });
  connect(sweep_, &SweepPanel::message, this, [this](const QString& text) {
    logInfo(text.toStdString());
    statusBar()->showMessage(text, 8000);
  });
  connect(sweep_, &SweepPanel::refused, this, [this](const QString& why) {
    logError(why.toStdString());
    showError(why);
  });
  connect(sweep_, &SweepPanel::statusChanged, this, [this](const QString& text) {
    sweepStatus_->setText(text);
    sweepStatus_->setVisible(!text.isEmpty());
  });
  connect(sweepStatus_, &QToolButton::clicked, this, [this] { showDock(QStringLiteral("sweepDock")); });
  connect(sweep_, &SweepPanel::busyChanged, this, [this](bool busy) {
    showPaused();
    if (!busy && closeAfterSweep_) close();
  });
}

void MainWindow::updateRegions() { viewport_->setRegions(showRegions_->isChecked() ? document_.regions() : std::vector<Region>()); }

void MainWindow::showComparison() {
  const CompareChoice& c = compare_.choice();
  ShownComparison shown;
  shown.pictures = compare_.pictures();
  // Until those of a new mode are there, the old ones stay as they were meant.
  shown.mode = c.mode == CompareMode::Off || shown.pictures.a.isNull() ? c.mode : shown.pictures.mode;
  shown.nameA = compare_.nameOf(c.a), shown.nameB = compare_.nameOf(c.b);
  shown.note = compare_.note();
  shown.wipe = c.wipe, shown.flickerHz = c.flickerHz;
  viewport_->setComparison(shown);
}

void MainWindow::showShortcuts() {
  auto* dialog = new ShortcutsDialog(*menuBar(), this);
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->open();
}

void MainWindow::stepExposure(double stops) {
  Display d = document_.preset().display;
  d.exposure = static_cast<float>(std::clamp(static_cast<double>(d.exposure) + stops, -kExposureLimit, kExposureLimit));
  document_.editDisplay(d, tr("exposure"));
}

void MainWindow::setPaused(bool paused) {
  link_.setPaused(paused);
  showPaused();
}

/// A sweep holds the session by its gate; what the person chose stands again afterwards.
void MainWindow::showPaused() { viewport_->setPaused(pause_->isChecked() || sweep_->runner().busy()); }

/// Not an edit: the preset keeps its view while the key is held.
void MainWindow::holdReference(bool held) {
  Display d = document_.preset().display;
  if (held) {
    errors_->setReferenceWanted(true);
    d.view = "reference";
  }
  link_.setDisplay(d);
}

void MainWindow::wantReferenceForView() {
  const std::string& v = document_.preset().display.view;
  if (v.rfind("reference", 0) == 0 || v.rfind("error", 0) == 0) errors_->setReferenceWanted(true);
}

void MainWindow::giveViewportCamera() {
  const auto scene = document_.scene();
  const auto camera = document_.camera();
  if (camera) viewport_->setCamera(*camera, scene ? scene->bounds.diagonal() : 0);
}

void MainWindow::goToBookmark(int number) {
  const auto scene = document_.scene();
  if (!scene) return;
  if (const auto own = bookmarks_.stored(scene->name, number)) {
    document_.moveCamera(*own);
    giveViewportCamera();
  } else if (static_cast<size_t>(number) <= scene->cameras.size()) {
    document_.useCamera(scene->cameras[static_cast<size_t>(number - 1)].name);
  } else {
    statusBar()->showMessage(tr("No camera %1; Ctrl+%1 keeps the present one there").arg(number), 4000);
  }
}

void MainWindow::storeBookmark(int number) {
  const auto scene = document_.scene();
  const auto camera = document_.camera();
  if (!scene || !camera) return;
  bookmarks_.store(scene->name, number, *camera);
  scenePanel_->readCameras();
  statusBar()->showMessage(tr("Camera kept under %1").arg(number), 4000);
}

/// The sweep writes its tables before it is over; then the window closes.
void MainWindow::askToStopSweep() {
  auto* box = new QMessageBox(QMessageBox::Question, tr("A sweep is running"),
                              tr("Stop it and close? What is done is kept, and the same experiment into the same folder goes on."), QMessageBox::NoButton, this);
  box->setObjectName(QStringLiteral("stopSweepQuestion"));
  QPushButton* stop = box->addButton(tr("&Stop and close"), QMessageBox::AcceptRole);
  box->setDefaultButton(box->addButton(tr("&Go on"), QMessageBox::RejectRole));
  box->setAttribute(Qt::WA_DeleteOnClose);
  connect(stop, &QPushButton::clicked, this, [this] {
    closeAfterSweep_ = true;
    sweep_->runner().cancelAll();
    if (!sweep_->runner().busy()) close();
  });
  box->open();
}

void MainWindow::closeEvent(QCloseEvent* event) {
  const bool worthAsking = document_.modified() && (!document_.path().isEmpty() || document_.undoStack().count() > 0);
  if (worthAsking && !closeDecided_) {
    event->ignore();
    auto* box = new QMessageBox(QMessageBox::Question, tr("Unsaved changes"), tr("Save the changes to this preset?"),
                                QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel, this);
    box->setAttribute(Qt::WA_DeleteOnClose);
    connect(box, &QMessageBox::finished, this, [this](int button) {
      if (button == QMessageBox::Discard) {
        closeDecided_ = true;
        close();
      } else if (button == QMessageBox::Save) {
        closeAfterSave_ = true;
        files_->save();
      }
    });
    box->open();
    return;
  }
  if (sweep_->runner().busy()) {
    event->ignore();
    if (!closeAfterSweep_) askToStopSweep();
    return;
  }
  saveLayout();
  QMainWindow::closeEvent(event);
}

void MainWindow::changeEvent(QEvent* event) {
  if (event->type() == QEvent::WindowStateChange) link_.setVisible(!isMinimized());
  QMainWindow::changeEvent(event);
}

void MainWindow::dragEnterEvent(QDragEnterEvent* event) {
  if (PresetActions::acceptable(*event->mimeData())) event->acceptProposedAction();
}

void MainWindow::openPath(const QString& path) { files_->openPath(path); }

void MainWindow::dropEvent(QDropEvent* event) {
  event->acceptProposedAction();
  files_->drop(*event->mimeData());
}

}  // namespace hl::ui
