#include "engine/scene/scene_bundle.h"
#include "ui/preset_actions.h"

#include <QAction>
#include <QApplication>
#include <QDateTime>
#include <QFileDialog>
#include <QFileInfo>
#include <QMenu>
#include <QMimeData>
#include <QPointer>
#include <QThreadPool>
#include <QUrl>

#include "ui/files.h"
#include "ui/image_feed.h"
#include "ui/settings.h"

namespace hl::ui {
namespace {

constexpr qsizetype kMostRecent = 10;
const QString kRecentKey = QStringLiteral("recentFiles"), kFolderKey = QStringLiteral("lastFolder");

}  // namespace

PresetActions::PresetActions(Document& document, EngineLink& link, ImageFeed& feed, Settings& settings, QWidget* window)
    : QObject(window), document_(document), link_(link), feed_(feed), settings_(settings), window_(window) {
  connect(&link_, &EngineLink::frameReady, this, &PresetActions::onFrame);
  connect(&document_, &Document::openedFile, this, [this](const QString& path, const QStringList&) {
    if (path.contains('/')) remember(path);  // not a scene's name
  });
  connect(&link_, &EngineLink::saved, this, [this](const QString& path, const QString& what) {
    if (what == "preset") remember(path);
  });
}

void PresetActions::fill(QMenu& menu) {
  const auto add = [&](const QString& text, const QKeySequence& key, void (PresetActions::*slot)()) {
    QAction* a = menu.addAction(text, this, slot);
    if (!key.isEmpty()) a->setShortcut(key);
    return a;
  };
  add(tr("&Open..."), QKeySequence::Open, &PresetActions::openFile);
  add(tr("Open s&cene or mesh..."), QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_O), &PresetActions::openSceneFile);
  presets_ = menu.addMenu(tr("&Presets"));
  presets_->setEnabled(false);
  recent_ = menu.addMenu(tr("&Recent"));
  fillRecent();
  menu.addSeparator();
  add(tr("&Save preset"), QKeySequence::Save, &PresetActions::save);
  add(tr("Save preset &as..."), QKeySequence(Qt::CTRL | Qt::SHIFT | Qt::Key_S), &PresetActions::saveAs);
  add(tr("Save sc&ene as..."), {}, &PresetActions::saveSceneAs);
  menu.addSeparator();
  add(tr("Save screens&hot..."), QKeySequence(Qt::Key_F12), &PresetActions::takeScreenshot);
}

void PresetActions::setPresets(const std::vector<PresetListing>& presets) {
  presets_->clear();
  for (const PresetListing& p : presets) {
    const QString path = QString::fromStdString(p.file.string());
    presets_->addAction(QString::fromStdString(p.label.empty() ? p.id : p.label), this, [this, path] { openPath(path); });
  }
  presets_->setEnabled(!presets.empty());
}

void PresetActions::openPath(const QString& path) {
  settings_.setValue(kFolderKey, QFileInfo(path).path());
  const QString extension = path.section('/', -1).section('.', 1).section('.', -1).toLower();
  if (!extension.isEmpty() && extension != QStringLiteral("json")) {
    document_.open(path);
    return;
  }
  // A folder, or one of the files that look alike: a worker looks into it.
  QThreadPool::globalInstance()->start([self = QPointer<PresetActions>(this), path] {
    const FileKind kind = kindOfFile(path.toStdString());
    QMetaObject::invokeMethod(
        qApp,
        [self, path, kind] {
          if (!self) return;
          if (kind == FileKind::Results)
            emit self->resultsOpened(path);
          else if (kind == FileKind::Experiment)
            emit self->experimentOpened(path);
          else
            self->document_.open(path);
        },
        Qt::QueuedConnection);
  });
}

QString PresetActions::startFolder() const { return settings_.value(kFolderKey).toString(); }

void PresetActions::openFile() {
  auto* dialog = new QFileDialog(window_, tr("Open"), startFolder(),
                                 tr("Presets, scenes, meshes, bundles, experiments, screenshots (*.json *.obj *.gltf *.glb *.hlb *.png *.exr);;All files (*)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setFileMode(QFileDialog::ExistingFile);
  connect(dialog, &QFileDialog::fileSelected, this, &PresetActions::openPath);
  dialog->open();  // not exec(): frames go on
}

void PresetActions::openSceneFile() {
  auto* dialog = new QFileDialog(window_, tr("Open scene or mesh"), startFolder(), tr("Scenes, meshes and bundles (*.json *.obj *.gltf *.glb *.hlb)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setFileMode(QFileDialog::ExistingFile);
  connect(dialog, &QFileDialog::fileSelected, this, &PresetActions::openPath);
  dialog->open();
}

void PresetActions::save() {
  // A bundle is more than its preset: that is saved as a file of its own. So is what was read in part.
  if (document_.path().isEmpty() || document_.readInPart() || isBundleFile(document_.path().toStdString()))
    saveAs();
  else
    document_.save(document_.path());
}

void PresetActions::saveAs() {
  auto* dialog = new QFileDialog(window_, tr("Save preset"), startFolder(), tr("Presets (*.json)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix(QStringLiteral("json"));
  connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& path) {
    settings_.setValue(kFolderKey, QFileInfo(path).path());
    document_.save(path);
  });
  dialog->open();
}

void PresetActions::saveSceneAs() {
  const auto frame = link_.latest();
  if (!frame) return;
  auto* dialog = new QFileDialog(window_, tr("Save scene"), startFolder(), tr("Scenes (*.json)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix(QStringLiteral("json"));
  connect(dialog, &QFileDialog::fileSelected, this, [this, frame](const QString& path) { link_.saveScene(frame, path); });
  dialog->open();
}

void PresetActions::takeScreenshot() {
  if (!link_.latest()) return;
  shotWanted_ = true;
  shot_.reset();
  shotPath_.clear();
  feed_.want(this, {"final", "display"});
  onFrame();
  auto* dialog = new QFileDialog(window_, tr("Save screenshot"), startFolder(), tr("As shown (*.png);;Linear picture (*.exr)"));
  dialog->setAttribute(Qt::WA_DeleteOnClose);
  dialog->setAcceptMode(QFileDialog::AcceptSave);
  dialog->setDefaultSuffix(QStringLiteral("png"));
  connect(dialog, &QFileDialog::filterSelected, dialog,
          [dialog](const QString& filter) { dialog->setDefaultSuffix(filter.contains(QStringLiteral("*.exr")) ? QStringLiteral("exr") : QStringLiteral("png")); });
  dialog->selectFile(QStringLiteral("halflight-%1").arg(QDateTime::currentDateTime().toString(QStringLiteral("yyyyMMdd-HHmmss"))));
  connect(dialog, &QFileDialog::fileSelected, this, [this](const QString& path) {
    settings_.setValue(kFolderKey, QFileInfo(path).path());
    shotPath_ = path;
    writeScreenshot();
  });
  connect(dialog, &QFileDialog::rejected, this, [this] {
    if (!shotPath_.isEmpty()) return;  // chosen before; it waits for its frame
    shotWanted_ = false;
    shot_.reset();
    feed_.want(this, {});
  });
  dialog->open();
}

/// The moment's picture, whatever the dialog takes: the first frame that came with what an EXR needs.
void PresetActions::onFrame() {
  if (!shotWanted_ || shot_) return;
  const auto frame = link_.latest();
  if (!frame || frame->display.empty() || !frame->images.count("final")) return;
  shot_ = frame;
  feed_.want(this, {});
  writeScreenshot();
}

void PresetActions::writeScreenshot() {
  if (!shot_ || shotPath_.isEmpty()) return;
  link_.saveScreenshot(shot_, shot_->preset, shotPath_);
  shotWanted_ = false;
  shot_.reset();
}

void PresetActions::remember(const QString& path) {
  QStringList files = settings_.value(kRecentKey).toStringList();
  files.removeAll(path);
  files.prepend(path);
  while (files.size() > kMostRecent) files.removeLast();
  settings_.setValue(kRecentKey, files);
  fillRecent();
}

void PresetActions::fillRecent() {
  if (!recent_) return;
  recent_->clear();
  const QStringList files = settings_.value(kRecentKey).toStringList();
  for (const QString& path : files) {
    QAction* a = recent_->addAction(path.section('/', -1), this, [this, path] { openPath(path); });
    a->setToolTip(path);
  }
  recent_->setToolTipsVisible(true);
  recent_->setEnabled(!files.isEmpty());
}

bool PresetActions::acceptable(const QMimeData& mime) {
  const QList<QUrl> urls = mime.urls();
  return urls.size() == 1 && urls.front().isLocalFile();
}

void PresetActions::drop(const QMimeData& mime) {
  if (acceptable(mime)) openPath(mime.urls().front().toLocalFile());
}

}  // namespace hl::ui
