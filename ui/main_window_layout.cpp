// The window's docks, and how their layout is kept.
#include <QDockWidget>
#include <QGuiApplication>
#include <QScreen>

#include "ui/compare_dock.h"
#include "ui/error_dock.h"
#include "ui/log_dock.h"
#include "ui/main_window.h"
#include "ui/profiler_dock.h"
#include "ui/scene_dock.h"
#include "ui/settings.h"
#include "ui/technique_dock.h"

namespace hl::ui {
namespace {

/// Raise it when docks come or go: an older layout is then left alone, and the default one shown.
constexpr int kLayoutVersion = 2;
const QString kLayoutKey = QStringLiteral("layout/state"), kGeometryKey = QStringLiteral("layout/geometry");
constexpr int kSideWidth = 380, kBottomHeight = 250;

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
  log_ = new LogPanel;
  setTabPosition(Qt::AllDockWidgetAreas, QTabWidget::North);
  setCorner(Qt::BottomRightCorner, Qt::RightDockWidgetArea);
  addDockWidget(Qt::RightDockWidgetArea, addDock(QStringLiteral("techniqueDock"), tr("Technique"), technique_));
  addDockWidget(Qt::RightDockWidgetArea, addDock(QStringLiteral("sceneDock"), tr("Scene"), scenePanel_));
  addDockWidget(Qt::BottomDockWidgetArea, addDock(QStringLiteral("profilerDock"), tr("Profiler"), profiler_));
  addDockWidget(Qt::BottomDockWidgetArea, addDock(QStringLiteral("errorDock"), tr("Error"), errors_));
  addDockWidget(Qt::BottomDockWidgetArea, addDock(QStringLiteral("compareDock"), tr("Compare"), comparePanel_));
  addDockWidget(Qt::BottomDockWidgetArea, addDock(QStringLiteral("logDock"), tr("Log"), log_));
  tabifyDockWidget(docks_[0], docks_[1]);
  tabifyDockWidget(docks_[2], docks_[3]);
  tabifyDockWidget(docks_[3], docks_[4]);
  tabifyDockWidget(docks_[4], docks_[5]);
  docks_[0]->raise();
  docks_[2]->raise();
  resizeDocks({docks_[0]}, {kSideWidth}, Qt::Horizontal);
  resizeDocks({docks_[2]}, {kBottomHeight}, Qt::Vertical);
}

void MainWindow::restoreLayout() {
  const QSize available = QGuiApplication::primaryScreen() ? QGuiApplication::primaryScreen()->availableSize() : QSize(1280, 800);
  resize(QSize(1440, 900).boundedTo(available * 0.95));
  defaultLayout_ = saveState(kLayoutVersion);
  restoreGeometry(settings_.value(kGeometryKey).toByteArray());
  restoreState(settings_.value(kLayoutKey).toByteArray(), kLayoutVersion);
}

void MainWindow::saveLayout() {
  settings_.setValue(kGeometryKey, saveGeometry());
  settings_.setValue(kLayoutKey, saveState(kLayoutVersion));
}

void MainWindow::resetLayout() {
  restoreState(defaultLayout_, kLayoutVersion);
  for (QDockWidget* dock : docks_) dock->show();
  docks_[0]->raise();
  docks_[2]->raise();
  resizeDocks({docks_[0]}, {kSideWidth}, Qt::Horizontal);
  resizeDocks({docks_[2]}, {kBottomHeight}, Qt::Vertical);
}

}  // namespace hl::ui
