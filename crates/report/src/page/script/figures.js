// Drawings of the page as images: an SVG becomes a PNG of twice its size.

const DRAWN = ['fill', 'fill-opacity', 'stroke', 'stroke-width', 'stroke-dasharray', 'font-family', 'font-size', 'font-weight', 'text-anchor', 'paint-order'];

function addImageButton(figure) {
  const svg = figure.querySelector('svg');
  if (!svg) return;
  const number = [...document.querySelectorAll('figure')].indexOf(figure) + 1;
  const save = button('PNG', 'Saves this figure as an image', () => saveDrawing(svg, `figure-${number}`), 'image');
  figure.querySelector('figcaption').append(element('p', { class: 'files' }, save));
}

function saveDrawing(svg, what) {
  // The copy stands alone, so that it takes along what the page says of its parts.
  const copy = svg.cloneNode(true);
  const [parts, copies] = [svg, copy].map((root) => root.querySelectorAll('*'));
  parts.forEach((part, at) => {
    const style = getComputedStyle(part);
    for (const name of DRAWN) copies[at].style.setProperty(name, style.getPropertyValue(name));
  });
  const { width, height } = svg.viewBox.baseVal;
  copy.setAttribute('width', 2 * width);
  copy.setAttribute('height', 2 * height);
  const image = new Image();
  image.addEventListener('load', () => {
    const canvas = element('canvas', { width: 2 * width, height: 2 * height });
    const pen = canvas.getContext('2d');
    pen.fillStyle = svg.closest('.drawing') ? '#ffffff' : scheme.look.back;
    pen.fillRect(0, 0, canvas.width, canvas.height);
    pen.drawImage(image, 0, 0);
    saveImage(canvas, what);
  });
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(new XMLSerializer().serializeToString(copy))}`;
}
