#include "ui/figure.h"

#include <QBuffer>
#include <QCoreApplication>
#include <QFont>
#include <QPageSize>
#include <QPainter>
#include <QPdfWriter>
#include <algorithm>
#include <cctype>
#include <cmath>

#include "engine/core/error.h"
#include "engine/core/files.h"
#include "engine/core/image_io.h"
#include "engine/experiment/open_target.h"
#include "ui/comparison.h"
#include "ui/files.h"

namespace hl::ui {
namespace {

constexpr double kGap = 6, kLine = 11, kPixelsPerPoint = 4;
constexpr int kFont = 8;                       // points
constexpr QRgb kInsetColours[] = {0xff0072b2, 0xffe69f00, 0xff009e73, 0xffd55e00, 0xffcc79a7, 0xff56b4e9};  // Okabe and Ito

QColor insetColour(size_t i) { return QColor::fromRgb(kInsetColours[i % std::size(kInsetColours)]); }

QRectF partOf(const Region& r, const QRectF& whole) {
  return {whole.x() + static_cast<double>(r.x) * whole.width(), whole.y() + static_cast<double>(r.y) * whole.height(), static_cast<double>(r.width) * whole.width(),
          static_cast<double>(r.height) * whole.height()};
}

void paintFigure(QPainter& painter, const FigureSheet& figure, const FigureLayout& layout) {
  const std::vector<QStringList> metrics = figureMetrics(figure);
  QFont plain = painter.font();
  plain.setPixelSize(kFont);
  QFont bold = plain;
  bold.setBold(true);
  painter.fillRect(QRectF(QPointF(), layout.page), Qt::white);
  hl::Display display = figure.display;
  display.view.clear();
  for (size_t i = 0; i < figure.images.size(); ++i) {
    const FigureImage& f = figure.images[i];
    const FigureCell& cell = layout.cells[i];
    const QImage picture = pictureOf(toneMapOnHost(*f.image, display), f.image->width, f.image->height);
    painter.setRenderHint(QPainter::SmoothPixmapTransform, false);  // pixels as they are
    painter.drawImage(cell.picture, picture);
    painter.setBrush(Qt::NoBrush);
    for (size_t k = 0; k < figure.insets.size(); ++k) {
      painter.drawImage(cell.insets[k], picture, partOf(figure.insets[k], QRectF(picture.rect())));
      QPen pen(insetColour(k), 1.2);
      pen.setJoinStyle(Qt::MiterJoin);
      painter.setPen(pen);
      painter.drawRect(partOf(figure.insets[k], cell.picture));
      painter.drawRect(cell.insets[k]);
    }
    painter.setPen(Qt::black);
    painter.setFont(bold);
    painter.drawText(cell.caption, Qt::AlignHCenter | Qt::AlignVCenter | Qt::TextWordWrap, f.caption);
    painter.setFont(plain);
    painter.drawText(cell.metrics, Qt::AlignHCenter | Qt::AlignTop, metrics[i].join('\n'));
  }
}

std::string fileName(size_t i, const char* what) { return std::to_string(i + 1) + "-" + what + ".json"; }

}  // namespace

FigureLayout layOut(const FigureSheet& figure) {
  FigureLayout out;
  const int count = static_cast<int>(figure.images.size());
  const int columns = std::clamp(count, 1, kFigureColumns);
  const double width = (kFigureWidth - kGap * (columns + 1)) / columns;
  const int insetColumns = std::clamp(static_cast<int>(figure.insets.size()), 1, 3);
  const double insetWidth = (width - kGap / 2 * (insetColumns - 1)) / insetColumns;
  double top = kGap;
  for (int first = 0; first < count; first += columns) {
    double bottom = top;
    for (int i = first; i < std::min(count, first + columns); ++i) {
      const Image& image = *figure.images[static_cast<size_t>(i)].image;
      FigureCell cell;
      const double x = kGap + (i - first) * (width + kGap);
      cell.picture = {x, top, width, width * image.height / image.width};
      double y = cell.picture.bottom() + kGap / 2;
      for (size_t k = 0; k < figure.insets.size(); k += static_cast<size_t>(insetColumns)) {
        double tallest = 0;
        for (size_t j = k; j < std::min(figure.insets.size(), k + static_cast<size_t>(insetColumns)); ++j) {
          const Region& r = figure.insets[j];
          const double aspect = static_cast<double>(r.height) * image.height / std::max(1e-6, static_cast<double>(r.width) * image.width);
          const double height = std::min(insetWidth * aspect, 1.5 * insetWidth);
          cell.insets.push_back({x + static_cast<double>(j - k) * (insetWidth + kGap / 2), y, std::min(insetWidth, height / aspect), height});
          tallest = std::max(tallest, height);
        }
        y += tallest + kGap / 2;
      }
      cell.caption = {x, y, width, 2 * kLine};
      cell.metrics = {x, cell.caption.bottom(), width, kLine * static_cast<double>(figure.truth ? figure.metrics.size() : 0)};
      bottom = std::max(bottom, cell.metrics.bottom());
      out.cells.push_back(cell);
    }
    top = bottom + kGap;
  }
  out.page = {kFigureWidth, top};
  return out;
}

std::vector<QStringList> figureMetrics(const FigureSheet& figure) {
  std::vector<QStringList> out(figure.images.size());
  if (!figure.truth) return out;
  for (size_t i = 0; i < figure.images.size(); ++i)
    for (const std::string& metric : figure.metrics) {
      if (figure.images[i].image == figure.truth) continue;  // itself
      const MetricResult result = measured(metric, *figure.images[i].image, *figure.truth, figure.images[i].context, howShown(figure.display));
      out[i] << QCoreApplication::translate("hl::ui::Figure", "%1 against %2").arg(errorText(metric, result), figure.truthName);
    }
  return out;
}

void writeFigure(const FigureSheet& figure, const std::filesystem::path& path) {
  if (figure.images.empty()) throw badInput(path.string() + ": a figure needs a picture at least");
  for (const FigureImage& f : figure.images)
    if (!f.image) throw badInput(path.string() + ": '" + f.caption.toStdString() + "' has no picture yet");
  std::string extension = path.extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const FigureLayout layout = layOut(figure);
  if (extension == ".pdf") {
    QByteArray bytes;
    QBuffer buffer(&bytes);
    buffer.open(QIODevice::WriteOnly);
    {
      QPdfWriter pdf(&buffer);
      pdf.setPageSize(QPageSize(layout.page, QPageSize::Point, {}, QPageSize::ExactMatch));
      pdf.setPageMargins({});
      pdf.setCreator(QStringLiteral("Halflight"));
      pdf.setResolution(1200);
      for (size_t i = 0; i < figure.images.size(); ++i) {
        if (!figure.images[i].frame) continue;
        const FrameResult& frame = *figure.images[i].frame;
        pdf.addFileAttachment(QString::fromStdString(fileName(i, "preset")), QByteArray::fromStdString(presetJson(frame.preset)), QStringLiteral("application/json"));
        pdf.addFileAttachment(QString::fromStdString(fileName(i, "provenance")), QByteArray::fromStdString(provenanceJson(frame)), QStringLiteral("application/json"));
      }
      QPainter painter(&pdf);
      painter.scale(pdf.width() / layout.page.width(), pdf.width() / layout.page.width());
      paintFigure(painter, figure, layout);
    }
    writeFileAtomically(path, std::string_view(bytes.constData(), static_cast<size_t>(bytes.size())));
    return;
  }
  if (extension != ".png") throw badInput(path.string() + ": figures are written as .png or .pdf");
  QImage page((layout.page * kPixelsPerPoint).toSize(), QImage::Format_RGB888);
  {
    QPainter painter(&page);
    painter.setRenderHint(QPainter::Antialiasing);
    painter.scale(kPixelsPerPoint, kPixelsPerPoint);
    paintFigure(painter, figure, layout);
  }
  Image out(page.width(), page.height(), 3);
  for (int y = 0; y < page.height(); ++y) {
    const unsigned char* line = page.constScanLine(y);
    for (int k = 0; k < page.width() * 3; ++k) out.pixel(0, y)[k] = static_cast<float>(line[k]) / 255.0f;
  }
  if (const auto& frame = figure.images.front().frame) {
    out.metadata[kPresetAttribute] = presetJson(frame->preset);
    out.metadata[kProvenanceAttribute] = provenanceJson(*frame);
  }
  writeImage(path, out);
}

}  // namespace hl::ui
