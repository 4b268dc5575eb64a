#include "ui/shader_watcher.h"

#include <QDirIterator>

#include "engine/core/files.h"

namespace hl::ui {
namespace {

constexpr int kSettleMs = 250;  // editors write in several steps

QStringList shaderSources() {
  const QStringList kinds{QStringLiteral("*.comp"), QStringLiteral("*.vert"), QStringLiteral("*.frag"),
                          QStringLiteral("*.glsl"), QStringLiteral("*.h"),    QStringLiteral("*.inl")};
  QStringList out;
  for (const char* folder : {"shaders", "engine/techniques"}) {
    const QString root = QString::fromStdString((homeFolder() / folder).string());
    out << root;
    for (QDirIterator it(root, QDir::Dirs | QDir::NoDotAndDotDot, QDirIterator::Subdirectories); it.hasNext();) out << it.next();
    for (QDirIterator it(root, kinds, QDir::Files, QDirIterator::Subdirectories); it.hasNext();) out << it.next();
  }
  return out;
}

/// Runs in the watcher's thread.
class Worker : public QObject {
 public:
  explicit Worker(std::function<void()> tell) : watcher_(this), settle_(this), tell_(std::move(tell)) {
    settle_.setSingleShot(true);
    settle_.setInterval(kSettleMs);
    const auto note = [this] { settle_.start(); };
    connect(&watcher_, &QFileSystemWatcher::fileChanged, this, note);
    connect(&watcher_, &QFileSystemWatcher::directoryChanged, this, note);
    connect(&settle_, &QTimer::timeout, this, [this] {
      watch();  // a file that was replaced is no longer watched
      tell_();
    });
  }
  void watch() {
    QStringList paths = shaderSources();
    const QStringList files = watcher_.files(), folders = watcher_.directories();
    const QSet<QString> known(files.begin(), files.end()), knownFolders(folders.begin(), folders.end());
    paths.removeIf([&](const QString& p) { return known.contains(p) || knownFolders.contains(p) || !QFile::exists(p); });
    if (!paths.isEmpty()) watcher_.addPaths(paths);
  }

 private:
  QFileSystemWatcher watcher_;
  QTimer settle_;
  std::function<void()> tell_;
};

}  // namespace

ShaderWatcher::ShaderWatcher(QObject* parent) : QObject(parent) {
  thread_.setObjectName(QStringLiteral("shader watcher"));
  auto* worker = new Worker([this] { QMetaObject::invokeMethod(this, &ShaderWatcher::changed, Qt::QueuedConnection); });
  worker->moveToThread(&thread_);
  connect(&thread_, &QThread::started, worker, &Worker::watch);
  connect(&thread_, &QThread::finished, worker, &QObject::deleteLater);
  thread_.start(QThread::LowPriority);
}

ShaderWatcher::~ShaderWatcher() {
  thread_.quit();
  thread_.wait();
}

}  // namespace hl::ui
