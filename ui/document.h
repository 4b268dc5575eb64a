#pragma once
// The experiment as the window holds it: a preset that widgets read and edit, its undo history and its file. It is the truth for the
// widgets; the session follows, and where it refuses an edit the document takes the session's preset instead.
#include <QObject>
#include <QString>
#include <QUndoStack>
#include <optional>
#include <set>

#include "ui/catalog.h"
#include "ui/engine_link.h"
#include "ui/pending_rebuild.h"

namespace hl::ui {

class Document : public QObject {
  Q_OBJECT
 public:
  Document(EngineLink&, const Catalog&, QObject* parent = nullptr);

  const Preset& preset() const { return preset_; }
  const Catalog& catalog() const { return catalog_; }
  QUndoStack& undoStack() { return undo_; }
  /// The parameter's text, or its default's.
  std::string parameter(const std::string& key) const;

  // Edits, each one step of undo. Edits with the same non-zero `drag` are one step together.
  void editParameters(const std::map<std::string, std::string>& texts, const QString& what, quint64 drag = 0);
  void editTechnique(const std::string& id);
  void editDisplay(const Display&, const QString& what, quint64 drag = 0);
  void editResolution(int width, int height);
  void editSeed(uint32_t);
  void editLights(const LightEdits&, const QString& what, quint64 drag = 0);
  /// Of interest; errors are measured for each. std::nullopt: the scene's own.
  void editRegions(const std::optional<std::vector<Region>>&, const QString& what, quint64 drag = 0);
  /// As they stand: the preset's, or the scene's.
  std::vector<Region> regions() const;
  /// By hand; std::nullopt: the scene's own. `use`: probes.placement becomes manual in the same step.
  void editProbes(const std::optional<std::vector<vec3>>&, bool use, const QString& what);
  /// Those by hand as they stand: the preset's, or the scene's.
  std::vector<vec3> probes() const;
  /// Edits that wait for a rebuild: the preset has them, the session not yet.
  PendingRebuild& pendingRebuild() { return pending_; }
  /// Back to what the session has; one step of undo.
  void revertRebuild();
  /// All of another experiment, camera included; this one's file stays. One step of undo.
  void restore(const Preset&, const QString& what);
  /// A number for a new drag.
  quint64 newDrag() { return ++lastDrag_; }

  // Looking round is no step of undo.
  void moveCamera(const Camera&);
  void useCamera(const std::string& name);
  /// Nor is letting time pass.
  void setPlayback(const Playback&);
  /// The scene's recorded flights, in place of those it has; saving the scene keeps them.
  void keepCameraPaths(const std::vector<CameraPath>&);
  /// The camera the picture is taken with, also where a path holds it; needs a scene for a named one.
  std::optional<Camera> camera() const;

  // Files.
  void open(const QString& path);
  void openScene(const QString& nameOrPath);
  void save(const QString& path);
  QString path() const { return QString::fromStdString(preset_.file.string()); }
  bool modified() const { return modified_; }
  /// Not all of the file was understood, or it is of another version: saving over it would lose what it holds.
  bool readInPart() const { return partlyRead_.count(preset_.file) > 0; }
  /// The whole experiment to a session that was started anew.
  void sendAll();
  /// True until the answer to open() or openScene() is there.
  bool opening() const { return opening_ > 0; }

  /// The scene's summary of the newest frame; null before the first.
  std::shared_ptr<const Scene> scene() const { return scene_; }

 signals:
  void presetChanged();                        ///< anything but the camera
  void techniqueChanged();
  void displayChanged();
  void cameraChanged(bool fromOutside);        ///< false: moved through moveCamera
  void regionsChanged();
  void probesChanged();
  void sceneChanged();                         ///< another scene, or its lights
  void modifiedChanged(bool modified);
  void openedFile(const QString& path, const QStringList& warnings);

 private:
  friend class PresetCommand;
  /// Makes `target` the preset and sends the session what differs; `whole`: all of it. Else camera and file stay as they are.
  void apply(const Preset& target, bool whole);
  void push(Preset target, const QString& what, quint64 drag);
  void sendLights(const std::optional<LightEdits>&);
  void sendTechnique(const Preset& target);
  void onOpened(const Preset&, const QString& from);
  void onPresetIs(const Preset&, quint64 ticket);
  void onFrame();
  void announceAll();
  void updateModified();
  void leavePath();
  std::string savedForm() const;

  EngineLink& link_;
  const Catalog& catalog_;
  QUndoStack undo_;
  PendingRebuild pending_;
  Preset preset_;
  std::string saved_;                          // as JSON, to compare with
  std::set<std::filesystem::path> partlyRead_;  // of the files that were opened: undo goes back to them
  std::optional<std::string> saving_;          // likewise, while the write runs
  std::map<std::string, std::map<std::string, std::string>> otherTechniques_;  // parameters of those not shown now
  std::optional<LightEdits> sceneLights_;      // as the scene's file has them
  std::vector<Region> sceneRegions_;           // likewise
  std::vector<vec3> sceneProbes_;              // likewise
  std::shared_ptr<const Scene> scene_;
  quint64 lastDrag_ = 0, edits_ = 0;
  int opening_ = 0;
  bool modified_ = false, first_ = true;
};

LightEdits lightsOf(const Scene&);

}  // namespace hl::ui
