#pragma once
// The scene's lights: a list, and the selected one's position, direction, colour and intensity. Emissive surfaces are listed, not edited.
#include <QWidget>

#include "ui/document.h"

class QDoubleSpinBox;
class QFormLayout;
class QLabel;
class QListWidget;
class QPushButton;

namespace hl::ui {

class LightsEditor : public QWidget {
  Q_OBJECT
 public:
  explicit LightsEditor(Document&, QWidget* parent = nullptr);

 private:
  enum class Kind { Point, Spot, Directional, Sky, Surface };
  struct Entry {
    Kind kind;
    size_t index;
  };
  void readScene();
  void readLights();
  void fillList();
  void showSelected();
  void edit();
  void add(Kind);
  void removeSelected();
  void commit(const QString& what, quint64 drag);
  vec3* colourOf(const Entry&);
  void chooseColour();

  Document& document_;
  LightEdits lights_;
  std::vector<Material> emitters_;
  std::vector<Entry> entries_;
  QListWidget* list_;
  QWidget* form_;
  QFormLayout* rows_;
  QDoubleSpinBox* position_[3];
  QDoubleSpinBox* direction_[3];
  QWidget* positionRow_;
  QWidget* directionRow_;
  QDoubleSpinBox* intensity_;
  QDoubleSpinBox* inner_;
  QDoubleSpinBox* outer_;
  QPushButton* colour_;
  QLabel* note_;
  vec3 hue_{1.0f};  ///< of the selected light, largest channel 1
  bool filling_ = false;
};

}  // namespace hl::ui
