// The slider of the opening crack: one frame at a time. Without this script all frames are shown.
for (const stepper of document.querySelectorAll(".stepper")) {
  const slider = stepper.querySelector("input"), said = stepper.querySelector("output");
  const frames = [...stepper.querySelectorAll(".frame")];
  const show = () => {
    frames.forEach((frame, i) => { frame.hidden = i !== Number(slider.value); });
    const { opening, said: words } = frames[slider.value].dataset;
    said.textContent = opening;
    slider.setAttribute("aria-valuetext", words);
  };
  slider.addEventListener("input", show);
  slider.closest(".controls").hidden = false;
  show();
}
