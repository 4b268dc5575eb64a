#pragma once
// One kind of undo step: the experiment before and after. Presets are small, and the document works out what differs.
#include <QUndoCommand>

#include "engine/experiment/preset.h"

namespace hl::ui {

class Document;

class PresetCommand : public QUndoCommand {
 public:
  /// Edits with the same `drag` merge; 0: never.
  PresetCommand(Document&, Preset before, Preset after, const QString& what, quint64 drag);
  /// An opened file or scene, which the session already shows: the first redo has nothing to do.
  static PresetCommand* opened(Document&, Preset before, Preset after, const QString& what);
  /// As opened(), for what the session does not show yet.
  static PresetCommand* whole(Document&, Preset before, Preset after, const QString& what);
  void undo() override;
  void redo() override;
  int id() const override { return 1; }
  bool mergeWith(const QUndoCommand* next) override;

 private:
  Document& document_;
  Preset before_, after_;
  quint64 drag_;
  bool whole_ = false;    ///< another file: camera and all
  bool applied_ = false;
};

}  // namespace hl::ui
