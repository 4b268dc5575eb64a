#pragma once
// The workbench: the viewport in the middle, the docks round it, and the menus.
#include <QElapsedTimer>
#include <QMainWindow>
#include <QTimer>
#include <memory>

#include "ui/bookmarks.h"
#include "ui/catalog.h"
#include "ui/compare.h"
#include "ui/document.h"
#include "ui/image_feed.h"
#include "ui/palette.h"
#include "ui/pass_table.h"
#include "ui/presenter_choice.h"

class QActionGroup;
class QDockWidget;
class QLabel;
class QMenu;
class QProgressBar;
class QToolButton;

namespace hl::ui {

class ComparePanel;
class ErrorPanel;
class InspectorPanel;
class LogPanel;
class PresetActions;
class ProfilerPanel;
class ProbesPanel;
class RegionsEditor;
class ScenePanel;
class ShaderWatcher;
class SweepPanel;
class TechniquePanel;
class Viewport;
class ViewportBar;

class MainWindow : public QMainWindow {
  Q_OBJECT
 public:
  /// `fileToOpen`: "" the default preset.
  MainWindow(EngineLink&, Settings&, const QString& fileToOpen);
  ~MainWindow() override;

  Document& document() { return document_; }
  Viewport& viewport() { return *viewport_; }
  Compare& compare() { return compare_; }
  TechniquePanel& techniquePanel() { return *technique_; }
  SweepPanel& sweepPanel() { return *sweep_; }
  QList<QDockWidget*> docks() const { return docks_; }
  QString noticeText() const { return error_; }
  /// For this run; what the menu was left at is kept in the settings.
  void setPresenterWish(PresenterWish);
  /// How the picture comes to the screen, and why so.
  QString presenterText() const { return presenterText_; }

 public slots:
  /// "tune", "compare" or "profile", as it was left; the present one is kept.
  void switchLayout(const QString& id);
  /// The present one as it was meant.
  void resetLayout();
  void showShortcuts();
  /// Whatever a person may open: a preset, scene, mesh, screenshot, bundle, experiment, or a folder of results.
  void openPath(const QString& path);

 protected:
  void closeEvent(QCloseEvent*) override;
  void changeEvent(QEvent*) override;
  void dragEnterEvent(QDragEnterEvent*) override;
  void dropEvent(QDropEvent*) override;

 private:
  QDockWidget* addDock(const QString& name, const QString& title, QWidget* panel);
  void buildDocks();
  void buildMenus();
  void buildCompareMenu();
  void showComparison();
  void buildStatusBar();
  void connectSweep();
  void askToStopSweep();
  void showDock(const QString& name);
  void connectEngine();
  void listFiles();
  void saveLayout();
  void restoreLayout();
  void arrange(const QString& id);
  void showLayout(const QString& id);

  void onFrame();
  void updatePanels();
  void updateProgress();
  void onFailed(const QString& message, ErrorKind);
  void showError(const QString&, bool lasting = false);
  void updateNotice();
  void updateTitle();
  void holdReference(bool held);
  void connectTools();
  void updateRegions();
  void connectProbes();
  void updateProbes();
  void wantReferenceForView();
  void goToBookmark(int number);
  void storeBookmark(int number);
  void stepExposure(double stops);
  void setPaused(bool);
  void showPaused();
  void giveViewportCamera();
  void restartEngine();
  void choosePresenter();
  void buildPresenterMenu(QMenu&);

  EngineLink& link_;
  Settings& settings_;
  Catalog catalog_;
  Document document_;
  ImageFeed feed_;
  Compare compare_;
  PassPalette palette_;
  PassModel passes_;
  Bookmarks bookmarks_;
  Viewport* viewport_;
  ViewportBar* bar_;
  TechniquePanel* technique_;
  ScenePanel* scenePanel_;
  ProfilerPanel* profiler_;
  ErrorPanel* errors_;
  RegionsEditor* regions_;
  ProbesPanel* probes_;
  ComparePanel* comparePanel_;
  InspectorPanel* inspector_;
  SweepPanel* sweep_;
  LogPanel* log_;
  PresetActions* files_;
  std::unique_ptr<ShaderWatcher> watcher_;
  QList<QDockWidget*> docks_;
  QString layout_;
  std::vector<std::pair<QString, QAction*>> layoutActions_;
  QAction* reloadOnChange_ = nullptr;
  QAction* pause_ = nullptr;
  QAction* regionTool_ = nullptr;
  QAction* showRegions_ = nullptr;
  QAction* probeTool_ = nullptr;
  QActionGroup* presenterActions_ = nullptr;
  PresenterWish presenterWish_ = PresenterWish::Auto;
  std::shared_ptr<Presenter> presenter_;  ///< the engine's, or null
  QString presenterText_;

  QLabel* status_ = nullptr;
  QProgressBar* loading_ = nullptr;
  QToolButton* cancelLoading_ = nullptr;
  QToolButton* restart_ = nullptr;
  QToolButton* sweepStatus_ = nullptr;
  QTimer panelTimer_, progressTimer_, errorTimer_;
  QElapsedTimer loadingSince_;
  const void* loadingWhat_ = nullptr;
  std::shared_ptr<const FrameResult> frame_;
  QString error_, frameMessage_;
  std::optional<QPoint> focusPixel_, probePixel_;
  bool closeDecided_ = false, closeAfterSave_ = false, closeAfterSweep_ = false;
};

}  // namespace hl::ui
