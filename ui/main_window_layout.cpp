// The window's docks, and how their layout is kept.
#include <QAction>
#include <QDockWidget>
#include <QGuiApplication>
#include <QScreen>
#include <vector>

#include "ui/compare_dock.h"
#include "ui/error_dock.h"
#include "ui/inspector.h"
#include "ui/log_dock.h"
#include "ui/main_window.h"
#include "ui/profiler_dock.h"
#include "ui/probes_panel.h"
#include "ui/regions_editor.h"
#include "ui/scene_dock.h"
#include "ui/settings.h"
#include "ui/sweep_dock.h"
#include "ui/technique_dock.h"

namespace hl::ui {
namespace {

/// Raise it when docks come or go: older layouts are then left alone, and the default ones shown.
constexpr int kLayoutVersion = 4;
const QString kLayoutKey = QStringLiteral("layout/state/"), kCurrentKey = QStringLiteral("layout/current"), kGeometryKey = QStringLiteral("layout/geometry");

/// Where docks go in a named layout: those of one list are tabs of one place, the first in front.
struct Arrangement {
  const char* id;
  QStringList right, rightBelow, bottom;
  int rightWidth, bottomHeight;
};

const std::vector<Arrangement>& arrangements() {
  static const std::vector<Arrangement> all = {
      {"tune", {"techniqueDock", "sceneDock", "probesDock"}, {}, {"profilerDock", "errorDock", "compareDock", "inspectorDock", "sweepDock", "logDock"}, 380, 250},
      {"compare", {"compareDock", "techniqueDock", "sceneDock", "probesDock"}, {"inspectorDock"}, {"errorDock", "profilerDock", "sweepDock", "logDock"}, 400, 190},
      {"profile", {"techniqueDock", "sceneDock", "probesDock"}, {}, {"profilerDock", "errorDock", "sweepDock", "compareDock", "inspectorDock", "logDock"}, 340, 480},
  };
  return all;
}

}  // namespace

QDockWidget* MainWindow::addDock(const QString& name, const QString& title, QWidget* panel) {
  auto* dock = new QDockWidget(title, this);
  dock->setObjectName(name);
  dock->setWidget(panel);
  dock->setFeatures(QDockWidget::DockWidgetMovable | QDockWidget::DockWidgetFloatable | QDockWidget::DockWidgetClosable);
  docks_ << dock;
  return dock;
}

void MainWindow::buildDocks() {
  technique_ = new TechniquePanel(document_, link_, passes_);
  scenePanel_ = new ScenePanel(document_, bookmarks_);
  profiler_ = new ProfilerPanel(palette_, passes_);
  errors_ = new ErrorPanel(link_);
  comparePanel_ = new ComparePanel(compare_, document_);
  inspector_ = new InspectorPanel(link_, document_, feed_);
  probes_ = new ProbesPanel(document_);
  regions_ = new RegionsEditor(document_);
  errors_->addPage(regions_, tr("Regions"));
  sweep_ = new SweepPanel(document_, link_, settings_, palette_);
  log_ = new LogPanel;
  setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
  setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
  addDock(QStringLiteral("techniqueDock"), tr("Technique"), technique_);
  addDock(QStringLiteral("sceneDock"), tr("Scene"), scenePanel_);
  addDock(QStringLiteral("probesDock"), tr("Probes"), probes_);
  addDock(QStringLiteral("profilerDock"), tr("Profiler"), profiler_);
  addDock(QStringLiteral("errorDock"), tr("Error"), errors_);
  addDock(QStringLiteral("compareDock"), tr("Compare"), comparePanel_);
  addDock(QStringLiteral("inspectorDock"), tr("Inspector"), inspector_);
  addDock(QStringLiteral("sweepDock"), tr("Sweep"), sweep_);
  addDock(QStringLiteral("logDock"), tr("Log"), log_);
}

/// Every dock to its place; one that no list names becomes a tab at the bottom.
void MainWindow::arrange(const QString& id) {
  const Arrangement* wanted = &arrangements().front();
  for (const Arrangement& a : arrangements())
    if (id == QLatin1String(a.id)) wanted = &a;
  QStringList bottom = wanted->bottom;
  for (const QDockWidget* dock : docks_)
    if (!(wanted->right + wanted->rightBelow + wanted->bottom).contains(dock->objectName())) bottom << dock->objectName();
  for (QDockWidget* dock : docks_) {
    dock->setFloating(false);
    removeDockWidget(dock);
  }
  const auto put = [&](const QStringList& names, Qt::DockWidgetArea area) {
    QDockWidget* first = nullptr;
    QDockWidget* last = nullptr;
    for (const QString& name : names) {
      QDockWidget* dock = findChild<QDockWidget*>(name);
      if (!dock) continue;
      if (last)
        tabifyDockWidget(last, dock);
      else
        addDockWidget(area, dock);
      dock->show();
      last = dock;
      if (!first) first = dock;
    }
    if (first) first->raise();
    return first;
  };
  QDockWidget* right = put(wanted->right, Qt::RightDockWidgetArea);
  put(wanted->rightBelow, Qt::RightDockWidgetArea);
  QDockWidget* below = put(bottom, Qt::BottomDockWidgetArea);
  resizeDocks({right}, {wanted->rightWidth}, Qt::Horizontal);
  resizeDocks({below}, {wanted->bottomHeight}, Qt::Vertical);
}

void MainWindow::restoreLayout() {
  const QSize available = QGuiApplication::primaryScreen() ? QGuiApplication::primaryScreen()->availableSize() : QSize(1280, 800);
  resize(QSize(1440, 900).boundedTo(available * 0.95));
  layout_ = settings_.value(kCurrentKey, QString::fromLatin1(arrangements().front().id)).toString();
  showLayout(layout_);
  restoreGeometry(settings_.value(kGeometryKey).toByteArray());
}

/// The layout as it was left, or as it is meant where it never was, or another version's.
void MainWindow::showLayout(const QString& id) {
  layout_ = id;
  arrange(id);
  restoreState(settings_.value(kLayoutKey + id).toByteArray(), kLayoutVersion);
  for (const auto& [other, action] : layoutActions_) action->setChecked(other == id);
}

void MainWindow::switchLayout(const QString& id) {
  saveLayout();
  showLayout(id);
}

void MainWindow::saveLayout() {
  settings_.setValue(kGeometryKey, saveGeometry());
  settings_.setValue(kCurrentKey, layout_);
  settings_.setValue(kLayoutKey + layout_, saveState(kLayoutVersion));
}

void MainWindow::resetLayout() {
  settings_.remove(kLayoutKey + layout_);
  arrange(layout_);
}

}  // namespace hl::ui
