// Numbers of the scene, each with what it is for.
import {element} from '../dom.js';
import {wrong_walls, type Engine, type Settings} from './draft.js';

export class SettingsForm {
  private readonly stiffness = element<HTMLInputElement>('set-stiffness');
  private readonly voxel = element<HTMLInputElement>('set-voxel');
  private readonly walls = element<HTMLInputElement>('set-walls');
  private readonly profile = element<HTMLSelectElement>('set-profile');
  private readonly law = element<HTMLSelectElement>('set-law');
  private readonly engine = element<HTMLSelectElement>('set-engine');
  private readonly budget = element<HTMLInputElement>('set-budget');

  constructor(changed: (settings: Settings) => void) {
    const fields = [this.stiffness, this.voxel, this.walls, this.profile, this.law, this.budget, this.engine];
    for (const field of fields)
      field.addEventListener('change', () => {
        this.walls.setCustomValidity(wrong_walls(this.walls.value.trim()));
        const wrong = fields.find((other) => !other.checkValidity());
        if (wrong) {
          wrong.reportValidity();
          return;
        }
        changed({
          stiffness: this.stiffness.valueAsNumber || 2000,
          voxel_mm: this.voxel.value === '' ? null : this.voxel.valueAsNumber,
          walls: this.walls.value.trim(),
          profile: this.profile.value as Settings['profile'],
          law: this.law.value as Settings['law'],
          budget_us: Number.isFinite(this.budget.valueAsNumber) ? this.budget.valueAsNumber * 1000 : 4000,
          engine: this.engine.value as Engine,
        });
      });
  }
  show(settings: Settings): void {
    this.stiffness.value = String(settings.stiffness);
    this.voxel.value = settings.voxel_mm === null ? '' : String(settings.voxel_mm);
    this.walls.value = settings.walls;
    this.walls.setCustomValidity('');
    this.profile.value = settings.profile;
    this.law.value = settings.law;
    this.engine.value = settings.engine;
    this.budget.value = String(settings.budget_us / 1000);
  }
}
